"""A small scene with VTK: a floor, three casters, a spot light and its shadow map (vtkShadowMapPass).

    xvfb-run -a stencilscope record --list -- python3 vtk_shadows.py [OPTION…]

    --cone DEGREES     the light's cone, from its axis: the map shows no more
    --texels N         the map's width and height
    --samples N        a pixel
    --size WxH         of the window; VTK reads its map with another matrix where that is not square
    --say FILE         also writes to FILE what is printed

Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field of
view in degrees.

From PyPI: vtk. Every mesh is made here.
"""

import argparse

import vtk

options = argparse.ArgumentParser()
options.add_argument("--cone", type=float, default=35.0)
options.add_argument("--texels", type=int, default=1024)
options.add_argument("--samples", type=int, default=0)
options.add_argument("--size", default="320x320")
options.add_argument("--say")
options = options.parse_args()
width, height = map(int, options.size.split("x"))

window = vtk.vtkRenderWindow()
window.SetSize(width, height)
window.SetMultiSamples(options.samples)
renderer = vtk.vtkOpenGLRenderer()
window.AddRenderer(renderer)


def add(source, at):
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(source.GetOutputPort())
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetPosition(*at)
    renderer.AddActor(actor)


floor = vtk.vtkPlaneSource()
floor.SetOrigin(-10, 0, 10)
floor.SetPoint1(10, 0, 10)
floor.SetPoint2(-10, 0, -10)
floor.SetResolution(10, 10)
add(floor, (0, 0, 0))
ball = vtk.vtkSphereSource()
ball.SetThetaResolution(32)
ball.SetPhiResolution(16)
add(ball, (0, 1.5, 0))
add(vtk.vtkCubeSource(), (2, 0.7, -1))
cone = vtk.vtkConeSource()
cone.SetResolution(40)
add(cone, (-2, 1, 0))

lamp = (4.0, 8.0, 4.0)
light = vtk.vtkLight()
light.SetPositional(True)
light.SetPosition(*lamp)
light.SetFocalPoint(0, 0, 0)
light.SetConeAngle(options.cone)
renderer.AddLight(light)

baker = vtk.vtkShadowMapBakerPass()
baker.SetResolution(options.texels)
shadows = vtk.vtkShadowMapPass()
shadows.SetShadowMapBakerPass(baker)
passes = vtk.vtkRenderPassCollection()
passes.AddItem(baker)
passes.AddItem(shadows)
sequence = vtk.vtkSequencePass()
sequence.SetPasses(passes)
of_camera = vtk.vtkCameraPass()
of_camera.SetDelegatePass(sequence)
renderer.SetPass(of_camera)
eye, target, up = (5.0, 6.0, 9.0), (0.0, 0.5, 0.0), (0.0, 1.0, 0.0)
camera = renderer.GetActiveCamera()
camera.SetPosition(*eye)
camera.SetFocalPoint(*target)
camera.SetViewUp(*up)
camera.SetViewAngle(30)

said = "version %s\nlight %r %r %r 1.0\ncamera %s\n" % (
    vtk.vtkVersion.GetVTKVersion(),
    *lamp,
    " ".join(map(repr, (*eye, *target, *up, camera.GetViewAngle()))),
)
print(said, end="", flush=True)
if options.say:
    with open(options.say, "w") as file:
        file.write(said)
while True:
    # VTK draws its map only when something has changed.
    light.Modified()
    window.Render()
