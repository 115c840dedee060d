"""A small scene with OGRE 1.12 on its core-profile OpenGL renderer: a floor, three casters, and shadows of one light: additive
stencil shadows, or a shadow map.

    xvfb-run -a stencilscope record --python /usr/bin/python3 --list -- /usr/bin/python3 ogre.py [OPTION…]

    --inside        the eye stands in a shadow
    --along         the light stands low, and the eye in a shadow, looking along it
    --far D         a far plane at distance D, which cuts the volumes
    --reach D       volumes end at distance D from the light instead of at infinity
    --texture KIND  a shadow map of 16 bits, of a spot or directional light, in place of stencil shadows
    --deep          a directional light's map is as deep as OGRE makes it: all casters lie within few of its steps
    --size WxH      of the window
    --say FILE      also writes to FILE what is printed

Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field of
view in degrees.

Debian: python3-ogre-1.12. Every mesh is made here; of OGRE's own files only its shaders are used.
"""

import argparse
import glob
import math
import os
import tempfile

import Ogre
import Ogre.Bites
import Ogre.RTShader

options = argparse.ArgumentParser()
options.add_argument("--inside", action="store_true")
options.add_argument("--along", action="store_true")
options.add_argument("--far", type=float)
options.add_argument("--reach", type=float)
options.add_argument("--texture", choices=["spot", "directional"])
options.add_argument("--deep", action="store_true")
options.add_argument("--size", default="320x240")
options.add_argument("--say")
options = options.parse_args()
width, height = map(int, options.size.split("x"))

root = Ogre.Root("", "", os.path.join(tempfile.mkdtemp(), "ogre.log"))
for plugin in ("RenderSystem_GL3Plus", "Codec_STBI"):
    root.loadPlugin(sorted(glob.glob("/usr/lib/*/OGRE/%s.so*" % plugin))[0])
root.setRenderSystem(root.getAvailableRenderers()[0])
root.initialise(False)
window = root.createRenderWindow("ogre", width, height, False)
groups = Ogre.ResourceGroupManager.getSingleton()
for folder in ("ShadowVolume", "RTShaderLib/GLSL", "RTShaderLib/materials"):
    groups.addResourceLocation("/usr/share/OGRE/Media/" + folder, "FileSystem", "OgreInternal")

scene = root.createSceneManager()
Ogre.RTShader.ShaderGenerator.initialize()
generator = Ogre.RTShader.ShaderGenerator.getSingleton()
generator.addSceneManager(scene)
listener = Ogre.Bites.SGTechniqueResolverListener(generator)
Ogre.MaterialManager.getSingleton().addListener(listener)
groups.initialiseAllResourceGroups()
scene.setAmbientLight(Ogre.ColourValue(0.2, 0.2, 0.2))
scheme = "ShaderGeneratorDefaultScheme"
if options.texture:
    # Shaders that OGRE generates read the map in the pass that lights.
    scene.setShadowTechnique(Ogre.SHADOWTYPE_TEXTURE_ADDITIVE_INTEGRATED)
    scene.setShadowTextureSettings(1024, 1, Ogre.PF_DEPTH16)
    scene.setShadowTextureSelfShadow(True)
    scene.setShadowFarDistance(800)
    if not options.deep:
        scene.setShadowDirectionalLightExtrusionDistance(500)
    state = generator.getRenderState(scheme)
    state.addTemplateSubRenderState(generator.createSubRenderState("SGX_IntegratedPSSM3"))
else:
    scene.setShadowTechnique(Ogre.SHADOWTYPE_STENCIL_ADDITIVE)
if options.reach is not None or options.far is not None:
    scene.setShadowUseInfiniteFarPlane(False)


def mesh(name, corners, triangles):
    """A flat-shaded closed mesh: every triangle has corners of its own."""
    made = scene.createManualObject(name)
    made.begin("BaseWhite", Ogre.RenderOperation.OT_TRIANGLE_LIST)
    for at, triangle in enumerate(triangles):
        a, b, c = (Ogre.Vector3(*corners[corner]) for corner in triangle)
        normal = (b - a).crossProduct(c - a).normalisedCopy()
        for corner in (a, b, c):
            made.position(corner)
            made.normal(normal)
        made.triangle(3 * at, 3 * at + 1, 3 * at + 2)
    made.end()
    shape = made.convertToMesh(name)
    shape.buildEdgeList()
    return name


def torus(around, across, major, minor):
    def corner(i, j):
        a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
        out = major + minor * math.cos(b)
        return out * math.cos(a), minor * math.sin(b), -out * math.sin(a)

    corners = [corner(i, j) for i in range(around) for j in range(across)]
    at = lambda i, j: i % around * across + j % across
    cells = [(i, j) for i in range(around) for j in range(across)]
    triangles = [(at(i, j), at(i + 1, j), at(i + 1, j + 1)) for i, j in cells]
    return corners, triangles + [(at(i, j), at(i + 1, j + 1), at(i, j + 1)) for i, j in cells]


BOX = [(x, y, z) for x in (-30, 30) for y in (-30, 30) for z in (-30, 30)]
BOX_SIDES = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
BOX_TRIANGLES = [(a, d, c) for a, b, c, d in BOX_SIDES] + [(a, c, b) for a, b, c, d in BOX_SIDES]
TETRAHEDRON = [(0, 45, 0), (40, -25, 25), (-40, -25, 25), (0, -25, -45)]
TETRAHEDRON_TRIANGLES = [(0, 2, 1), (0, 3, 2), (0, 1, 3), (1, 2, 3)]


def put(name, at, turned=0.0, casts=True):
    entity = scene.createEntity(name)
    entity.setCastShadows(casts)
    node = scene.getRootSceneNode().createChildSceneNode()
    node.attachObject(entity)
    node.setPosition(Ogre.Vector3(*at))
    node.yaw(Ogre.Radian(turned))


floor = [(-400, 0, -400), (-400, 0, 400), (400, 0, 400), (400, 0, -400)]
put(mesh("floor", floor, [(0, 1, 2), (0, 2, 3)]), (0, 0, 0), casts=False)
put(mesh("torus", *torus(24, 12, 42, 16)), (-70, 60, 0), 0.3)
put(mesh("box", BOX, BOX_TRIANGLES), (60, 60, 20), 0.5)
put(mesh("tetrahedron", TETRAHEDRON, TETRAHEDRON_TRIANGLES), (0, 40, 110), 0.2)

eye, target, lamp = (0, 150, 400), (0, 30, 0), (120, 260, 90)
if options.inside:
    eye, target = (38, 14, 6), (-80, 20, 10)
if options.along:
    eye, target, lamp = (-15, 47, -5), (-200, 0, -70), (360, 110, 120)
camera = scene.createCamera("camera")
camera.setNearClipDistance(1)
camera.setAutoAspectRatio(True)
if options.far is not None:
    camera.setFarClipDistance(options.far)
node = scene.getRootSceneNode().createChildSceneNode()
node.attachObject(camera)
node.setPosition(Ogre.Vector3(*eye))
node.lookAt(Ogre.Vector3(*target), Ogre.Node.TS_WORLD, Ogre.Vector3(0, 0, -1))
light = scene.createLight("light")
kinds = {None: Ogre.Light.LT_POINT, "spot": Ogre.Light.LT_SPOTLIGHT, "directional": Ogre.Light.LT_DIRECTIONAL}
light.setType(kinds[options.texture])
node = scene.getRootSceneNode().createChildSceneNode()
node.attachObject(light)
node.setPosition(Ogre.Vector3(*lamp))
if options.texture:
    node.lookAt(Ogre.Vector3(0, 0, 0), Ogre.Node.TS_WORLD, Ogre.Vector3(0, 0, -1))
    light.setSpotlightRange(Ogre.Radian(1.2), Ogre.Radian(1.4))
    if not options.deep:
        light.setShadowNearClipDistance(20)
        light.setShadowFarClipDistance(1000)
if options.reach is not None:
    # Without an infinite far plane, OGRE ends volumes where the light does.
    light.setAttenuation(options.reach, 1, 0, 0)

view = window.addViewport(camera)
view.setBackgroundColour(Ogre.ColourValue(0.1, 0.1, 0.3))
view.setMaterialScheme(scheme)
above = camera.getDerivedUp()
said = "version %s\nlight %s\ncamera %s\n" % (
    ".".join(str(getattr(Ogre, "OGRE_VERSION_" + part)) for part in ("MAJOR", "MINOR", "PATCH")),
    " ".join(map(str, (*lamp, 0 if options.texture == "directional" else 1))),
    " ".join(map(repr, (*eye, *target, above.x, above.y, above.z, camera.getFOVy().valueDegrees()))),
)
print(said, end="", flush=True)
if options.say:
    with open(options.say, "w") as file:
        file.write(said)
for _ in range(100):
    root.renderOneFrame()
# OGRE's own end needs objects to go in an order that Python does not keep.
os._exit(0)
