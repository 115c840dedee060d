"""Boxes, spheres and a ring with shadows in Blender's viewport, which its Workbench engine draws: `blender --factory-startup
--python blender_shadows.py -- [--view 1..3] [--say FILE]`.

Workbench counts each caster in the stencil in front of the surface or behind it, as the eye needs, and lights the picture by
draws of the whole screen that the stencil lets through.
"""

import argparse
import math
import sys

import bpy
import mathutils

words = argparse.ArgumentParser()
words.add_argument("--view", type=int, choices=[1, 2, 3], default=1)
words.add_argument("--say", default=None)
options = words.parse_args(sys.argv[sys.argv.index("--") + 1 :])

bpy.context.preferences.view.show_splash = False
# Else what has not changed is not drawn again.
bpy.context.preferences.system.viewport_aa = "OFF"
for one in list(bpy.data.objects):
    bpy.data.objects.remove(one)
bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, -0.25))
bpy.context.object.scale = (30, 30, 0.5)
bpy.ops.mesh.primitive_cube_add(size=1, location=(-4, 2, 2.6))
bpy.context.object.scale = (3, 3, 5)
bpy.context.object.rotation_euler = (0, 0, 0.5)
bpy.ops.mesh.primitive_uv_sphere_add(radius=1.6, segments=24, ring_count=12, location=(3, 0, 2.2))
bpy.ops.mesh.primitive_torus_add(major_radius=1.2, minor_radius=0.4, location=(0, -4, 1.5), rotation=(0.7, 0.3, 0))

towards = (0.4, 0.7, 0.45)
bpy.context.scene.display.light_direction = towards
eye, target = [
    ((6.0, -18.0, 12.0), (0.0, 0.0, 1.0)),
    ((-14.0, -9.0, 7.0), (0.0, 0.0, 1.0)),
    ((1.0, -9.0, 1.2), (-1.0, 3.0, 2.0)),
][options.view - 1]


def view_area():
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")


def set_up():
    space = view_area().spaces.active
    space.overlay.show_overlays = False
    space.show_gizmo = False
    space.show_region_header = space.show_region_toolbar = space.show_region_ui = False
    shading = space.shading
    shading.type, shading.light, shading.show_shadows, shading.shadow_intensity = "SOLID", "STUDIO", True, 0.6
    shading.show_specular_highlight = False
    look = mathutils.Vector(target) - mathutils.Vector(eye)
    view = space.region_3d
    view.view_perspective = "PERSP"
    view.view_rotation = look.to_track_quat("-Z", "Y")
    view.view_distance = look.length
    view.view_location = target
    return None


said = None


def say():
    """Says what the frame that is about to be drawn shows, if the one before it showed something else."""
    global said
    view = bpy.context.region_data
    # Panels that open or close change what the view has of the window.
    degrees = 2 * math.degrees(math.atan(1 / view.window_matrix[1][1]))
    text = "version %s\nlight %s\ncamera %s\n" % (
        bpy.app.version_string,
        " ".join(map(repr, (towards[0], -towards[2], towards[1], 0.0))),
        " ".join(map(repr, (*eye, *target, 0.0, 0.0, 1.0, degrees))),
    )
    if text != said:
        print(text, end="", flush=True)
        if options.say:
            with open(options.say, "w") as file:
                file.write(text)
        said = text


def draw_again():
    view_area().tag_redraw()
    return 0.05


bpy.types.SpaceView3D.draw_handler_add(say, (), "WINDOW", "PRE_VIEW")
bpy.app.timers.register(set_up, first_interval=0.5)
bpy.app.timers.register(draw_again, first_interval=1.0)
