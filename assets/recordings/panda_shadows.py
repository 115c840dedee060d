"""A small scene with Panda3D and simplepbr: a floor, three casters, one light and its shadow map.

    xvfb-run -a env GALLIVM_PERF=nopt stencilscope record -o DIR -- python3 panda_shadows.py [OPTION…]

    --light KIND       spot or directional
    --near D           the near plane of the light's view
    --far D            its far plane
    --wide W           width and height of a directional light's view
    --left-out         the larger ball is not drawn into the map
    --size WxH         of the window
    --say FILE         also writes to FILE what is printed

Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field of
view in degrees.

Mesa's software driver fails to compile these shaders unless GALLIVM_PERF=nopt is set, where they are recorded and where they
are replayed.

From PyPI: panda3d panda3d-simplepbr. Every mesh is made here.
"""

import argparse
import math

from panda3d import core

options = argparse.ArgumentParser()
options.add_argument("--light", default="spot", choices=["spot", "directional"])
options.add_argument("--near", type=float, default=1.0)
options.add_argument("--far", type=float, default=60.0)
options.add_argument("--wide", type=float, default=40.0)
options.add_argument("--left-out", action="store_true")
options.add_argument("--size", default="320x240")
options.add_argument("--say")
options = options.parse_args()

# RenderDoc records no compatibility profile.
core.loadPrcFileData("", "win-size %s\ngl-version 3 2\naudio-library-name null\n" % options.size.replace("x", " "))

import simplepbr
from direct.showbase.ShowBase import ShowBase

base = ShowBase()
simplepbr.init(enable_shadows=True, msaa_samples=0, use_normal_maps=False)
base.disableMouse()


def add(shape, at):
    positions, normals, triangles = shape
    data = core.GeomVertexData("shape", core.GeomVertexFormat.getV3n3(), core.Geom.UHStatic)
    vertex, normal = core.GeomVertexWriter(data, "vertex"), core.GeomVertexWriter(data, "normal")
    for position, direction in zip(positions, normals):
        vertex.addData3(*position)
        normal.addData3(*direction)
    primitive = core.GeomTriangles(core.Geom.UHStatic)
    for triangle in triangles:
        primitive.addVertices(*triangle)
    geometry = core.Geom(data)
    geometry.addPrimitive(primitive)
    node = core.GeomNode("shape")
    node.addGeom(geometry)
    path = base.render.attachNewNode(node)
    path.setPos(*at)
    return path


def box(*sides):
    positions, normals, triangles = [], [], []
    for axis in range(3):
        for sign in (-1, 1):
            first = len(positions)
            for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner, normal = [0, 0, 0], [0, 0, 0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = sign, i, j
                normal[axis] = sign
                positions.append([place * side / 2 for place, side in zip(corner, sides)])
                normals.append(normal)
            a, b, c, d = range(first, first + 4)
            triangles += [(a, b, c), (a, c, d)] if sign > 0 else [(a, c, b), (a, d, c)]
    return positions, normals, triangles


def ball(radius, around, down):
    def direction(i, j):
        a, b = 2 * math.pi * i / around, math.pi * j / down
        return math.sin(b) * math.cos(a), math.sin(b) * math.sin(a), math.cos(b)

    normals = [direction(i, j) for j in range(down + 1) for i in range(around + 1)]
    at = lambda i, j: j * (around + 1) + i
    cells = [(i, j) for j in range(down) for i in range(around)]
    triangles = [(at(i, j), at(i, j + 1), at(i + 1, j)) for i, j in cells]
    triangles += [(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)) for i, j in cells]
    return [[radius * c for c in normal] for normal in normals], normals, triangles


add(box(30, 30, 0.5), (0, 0, -0.25))
add(box(3, 3, 5), (-4, 2, 2.6))
larger = add(ball(1.6, 24, 12), (3, 0, 2.2))
add(ball(0.9, 40, 20), (0, -4, 1.5))

lamp = (8.0, -6.0, 14.0)
if options.light == "spot":
    light = core.Spotlight("spot")
    light.setLens(core.PerspectiveLens())
    light.getLens().setFov(70)
    light.setColor((900, 900, 900, 1))
    light.setAttenuation((0, 0, 1))
else:
    light = core.DirectionalLight("sun")
    light.getLens().setFilmSize(options.wide, options.wide)
    light.setColor((3, 3, 3, 1))
light.getLens().setNearFar(options.near, options.far)
light.setShadowCaster(True, 1024, 1024)
if options.left_out:
    # Cameras show what shares a bit with their mask.
    light.setCameraMask(core.BitMask32.bit(5))
    larger.hide(core.BitMask32.bit(5))
of_light = base.render.attachNewNode(light)
of_light.setPos(*lamp)
of_light.lookAt(0, 0, 0)
base.render.setLight(of_light)
ambient = core.AmbientLight("ambient")
ambient.setColor((0.3, 0.3, 0.3, 1))
base.render.setLight(base.render.attachNewNode(ambient))
eye, target, up = (6.0, -18.0, 12.0), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0)
base.camera.setPos(*eye)
base.camera.lookAt(*target)

said = "version %s\nlight %s\ncamera %s\n" % (
    core.PandaSystem.getVersionString(),
    " ".join(map(repr, (*lamp, 1.0 if options.light == "spot" else 0.0))),
    " ".join(map(repr, (*eye, *target, *up, base.camLens.getVfov()))),
)
print(said, end="", flush=True)
if options.say:
    with open(options.say, "w") as file:
        file.write(said)
base.run()
