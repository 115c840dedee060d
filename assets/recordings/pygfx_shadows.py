"""A small scene with pygfx, which draws with wgpu: a floor, three casters, and one light with a shadow map.

    xvfb-run -a stencilscope record --list -- python3 pygfx_shadows.py [OPTION…]

    --light KIND       directional, spot or point
    --cull FACES       which faces the map leaves out: front (as pygfx does by itself), back or none
    --bias B           what the shader takes off a depth before it compares
    --far D            the far plane of the light's view
    --near D           its near plane
    --wide W           width and height of a directional light's view
    --open             the box has no side towards the light, and none below
    --left-out         the ball is not drawn into the map
    --size WxH         of the window
    --say FILE         also writes to FILE what is printed

Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field of
view in degrees.

From PyPI: pygfx rendercanvas glfw. Every mesh is made here.
"""

import argparse
import math

import numpy as np
import pygfx as gfx
from rendercanvas.glfw import RenderCanvas, loop

options = argparse.ArgumentParser()
options.add_argument("--light", default="directional", choices=["directional", "spot", "point"])
options.add_argument("--cull", default="front", choices=["front", "back", "none"])
options.add_argument("--bias", type=float, default=0.0)
options.add_argument("--far", type=float, default=80.0)
options.add_argument("--near", type=float, default=0.5)
options.add_argument("--wide", type=float, default=46.0)
options.add_argument("--open", action="store_true")
options.add_argument("--left-out", action="store_true")
options.add_argument("--size", default="320x240")
options.add_argument("--say")
options = options.parse_args()
width, height = map(int, options.size.split("x"))

canvas = RenderCanvas(size=(width, height), update_mode="continuous", max_fps=60)
renderer = gfx.renderers.WgpuRenderer(canvas, pixel_ratio=1, ppaa="none")
scene = gfx.Scene()
grey = gfx.MeshPhongMaterial(color=(0.7, 0.7, 0.7, 1))


def add(geometry, at):
    mesh = gfx.Mesh(geometry, grey)
    mesh.local.position = at
    mesh.cast_shadow = mesh.receive_shadow = True
    scene.add(mesh)
    return mesh


def open_box(x, y, z):
    """A box of which two sides are left: one away from the light, and the top."""
    box = gfx.box_geometry(x, y, z)
    corners, indices = box.positions.data, box.indices.data
    normals = np.cross(
        corners[indices[:, 1]] - corners[indices[:, 0]], corners[indices[:, 2]] - corners[indices[:, 0]]
    )
    kept = indices[(normals[:, 1] > 0) | (normals[:, 2] > 0)]
    return gfx.Geometry(positions=corners, normals=box.normals.data, indices=np.ascontiguousarray(kept))


floor = add(gfx.plane_geometry(40, 40), (0, 0, 0))
floor.local.rotation = (-(0.5**0.5), 0, 0, 0.5**0.5)
add((open_box if options.open else gfx.box_geometry)(4, 6, 3), (-7, 3.2, 2))
add(gfx.torus_knot_geometry(2, 0.6, 64, 12), (2, 5, 0))
ball = add(gfx.sphere_geometry(2, 24, 12), (9, 2.5, -3))
ball.cast_shadow = not options.left_out
scene.add(gfx.AmbientLight(intensity=0.3))
if options.light == "directional":
    light = gfx.DirectionalLight("#ffffff", 3)
    light.shadow.camera.width = light.shadow.camera.height = options.wide
elif options.light == "spot":
    light = gfx.SpotLight("#ffffff", 1500, angle=0.8)
else:
    light = gfx.PointLight("#ffffff", 1500)
lamp = (8.0, 18.0, 12.0)
light.local.position = lamp
if options.light != "point":
    light.look_at((0, 0, 0))
light.cast_shadow = True
light.shadow.cull_mode, light.shadow.bias = options.cull, options.bias
light.shadow.camera.depth_range = (options.near, options.far)
scene.add(light)
camera = gfx.PerspectiveCamera(60, width / height, depth_range=(0.5, 300))
eye, target, up = (5.0, 12.0, 26.0), (0.0, 2.0, 0.0), (0.0, 1.0, 0.0)
camera.local.position = eye
camera.look_at(target)
# What pygfx calls its field of view is neither the height's nor the width's.
camera.set_view_size(width, height)
degrees = math.degrees(2 * math.atan(1 / float(camera.projection_matrix[1, 1])))
said = "version %s\nlight %s\ncamera %s\n" % (
    gfx.__version__,
    " ".join(map(repr, (*lamp, 0.0 if options.light == "directional" else 1.0))),
    " ".join(map(repr, (*eye, *target, *up, degrees))),
)
print(said, end="", flush=True)
if options.say:
    with open(options.say, "w") as file:
        file.write(said)
canvas.request_draw(lambda: renderer.render(scene, camera))
loop.run()
