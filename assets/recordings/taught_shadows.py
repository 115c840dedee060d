"""Shadow maps as they are taught, in OpenGL's core profile: a floor, a box, two balls, one light and its map.

    xvfb-run -a stencilscope record --python /usr/bin/python3 -o DIR -- /usr/bin/python3 taught_shadows.py [OPTION…]

    --kind KIND      cube: a point light, whose cube of depths is drawn by one layered draw a mesh (gl_Layer in a geometry
                     shader) and holds length(world − light) / far, written by gl_FragDepth
                     cascades: a directional light, with a depth map for each part of the view, that are drawn one after
                     the other, and chosen by the distance from the eye
                     moments: a spot light, whose map holds depth and its square as colours (a variance shadow map), with a
                     renderbuffer for the depth test
    --in WHERE       where cascades are: layers of one texture, an atlas (viewports of one texture), or textures of their own
    --blur           moments are blurred over 5 × 5 texels, along one side and then the other, into textures of their own
    --bias F         what is taken off before the comparison: this part of what is taught
    --far D          the far plane of the light's view
    --texels N       along a side of the map
    --left-out       the larger ball is not drawn into the map
    --size WxH       of the window
    --say FILE       also writes to FILE what is printed

Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field of
view in degrees; for a cube `distance FAR`, as its map holds distances.

Debian: python3-pygame python3-opengl python3-numpy. Every mesh is made here.
"""

import argparse
import ctypes

import numpy as np
import pygame
from OpenGL.GL import *

options = argparse.ArgumentParser()
options.add_argument("--kind", default="cube", choices=["cube", "cascades", "moments"])
options.add_argument("--in", dest="place", default="layers", choices=["layers", "atlas", "textures"])
options.add_argument("--bias", type=float, default=1.0)
options.add_argument("--far", type=float)
options.add_argument("--texels", type=int, default=512)
options.add_argument("--blur", action="store_true")
options.add_argument("--left-out", action="store_true")
options.add_argument("--size", default="320x240")
options.add_argument("--say")
options = options.parse_args()
width, height = map(int, options.size.split("x"))
texels, far = options.texels, options.far or 40.0

# A vertex has its place and its normal; all are in the world.
MESH = """#version 330 core
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
out vec3 world;
out vec3 facing;
void main() {
    world = place;
    facing = normal;
    gl_Position = clip_from_world * vec4(place, 1.);
}"""

PLACE = """#version 330 core
layout(location = 0) in vec3 place;
void main() { gl_Position = vec4(place, 1.); }"""

SIX_LAYERS = """#version 330 core
layout(triangles) in;
layout(triangle_strip, max_vertices = 18) out;
uniform mat4 faces[6];
out vec4 world;
void main() {
    for (int face = 0; face < 6; ++face) {
        gl_Layer = face;
        for (int corner = 0; corner < 3; ++corner) {
            world = gl_in[corner].gl_Position;
            gl_Position = faces[face] * world;
            EmitVertex();
        }
        EndPrimitive();
    }
}"""

DISTANCE = """#version 330 core
in vec4 world;
uniform vec3 light;
uniform float far;
void main() { gl_FragDepth = length(world.xyz - light) / far; }"""

DEPTH = """#version 330 core
void main() {}"""

MOMENTS = """#version 330 core
out vec2 moments;
void main() {
    float depth = gl_FragCoord.z;
    float dx = dFdx(depth), dy = dFdy(depth);
    moments = vec2(depth, depth * depth + .25 * (dx * dx + dy * dy));
}"""

CORNERS = """#version 330 core
void main() { gl_Position = vec4(gl_VertexID / 2 * 4 - 1, gl_VertexID % 2 * 4 - 1, 0., 1.); }"""

BLUR = """#version 330 core
out vec2 moments;
uniform sampler2D map;
uniform ivec2 along;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(map, 0) - 1;
    moments = vec2(0.);
    for (int step = -2; step <= 2; ++step)
        moments += texelFetch(map, clamp(at + step * along, ivec2(0), last), 0).rg / 5.;
}"""

LIT = """#version 330 core
in vec3 world;
in vec3 facing;
out vec4 color;
uniform vec4 light;
uniform float far, bias;
uniform mat4 view, maps[3];
uniform vec3 ends;
%s
void main() {
    vec3 towards = normalize(light.xyz - world * light.w), normal = normalize(facing);
    float cosine = max(dot(towards, normal), 0.);
    color = vec4(vec3(.8, .75, .7) * (.25 + .75 * cosine * arriving(cosine)), 1.);
}"""

ARRIVING = {
    "cube": """
uniform samplerCube map;
float arriving(float cosine) {
    vec3 to = world - light.xyz;
    return length(to) - bias * mix(.5, .1, cosine) <= texture(map, to).r * far ? 1. : 0.;
}""",
    "cascades": """
%s
float arriving(float cosine) {
    float distance = -(view * vec4(world, 1.)).z;
    int layer = distance < ends.x ? 0 : distance < ends.y ? 1 : 2;
    vec4 clip = maps[layer] * vec4(world, 1.);
    vec3 at = clip.xyz / clip.w * .5 + .5;
    return at.z - bias * mix(.01, .002, cosine) <= nearest(at.xy, layer) ? 1. : 0.;
}"""
    % {
        "layers": "uniform sampler2DArray map; float nearest(vec2 at, int layer) { return texture(map, vec3(at, layer)).r; }",
        "atlas": """
uniform sampler2D map;
float nearest(vec2 at, int layer) { return texture(map, (at + vec2(layer % 2, layer / 2)) / 2.).r; }""",
        "textures": """
uniform sampler2D map, second, third;
float nearest(vec2 at, int layer) {
    return layer == 0 ? texture(map, at).r : layer == 1 ? texture(second, at).r : texture(third, at).r;
}""",
    }[options.place],
    "moments": """
uniform sampler2D map;
float arriving(float cosine) {
    vec4 clip = maps[0] * vec4(world, 1.);
    vec3 at = clip.xyz / clip.w * .5 + .5;
    vec2 moments = texture(map, at.xy).rg;
    float over = at.z - moments.x, variance = max(moments.y - moments.x * moments.x, 2e-6 * bias);
    // Chebyshev: at most so much of what is nearby lies beyond.
    return over <= 0. ? 1. : smoothstep(.3, 1., variance / (variance + over * over));
}""",
}


def normalized(vector):
    return np.array(vector, float) / np.linalg.norm(vector)


def look_at(eye, target, up):
    back = normalized(np.subtract(eye, target))
    right = normalized(np.cross(up, back))
    turn = np.array([right, np.cross(back, right), back])
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = turn, -turn @ np.array(eye, float)
    return view


def perspective(degrees, aspect, near, far):
    focal = 1 / np.tan(np.radians(degrees) / 2)
    clip = np.diag([focal / aspect, focal, (far + near) / (near - far), 0.0])
    clip[2, 3], clip[3, 2] = 2 * far * near / (near - far), -1
    return clip


def parallel(low, high):
    """A view along −z of a box from its lower to its upper corner."""
    clip = np.diag([*(2 / (high - low)), 1.0])
    clip[:3, 3] = -(high + low) / (high - low)
    clip[2] *= -1
    clip[2, 3] = (high + low)[2] / (high - low)[2]
    return clip


def box(middle, sides):
    made = []
    for axis in range(3):
        for sign in (-1, 1):
            corners = np.zeros((4, 3))
            corners[:, axis] = sign
            corners[:, (axis + 1) % 3], corners[:, (axis + 2) % 3] = (-1, 1, 1, -1), (-1, -1, 1, 1)
            normal = np.eye(3)[axis] * sign
            order = (0, 1, 2, 0, 2, 3) if sign > 0 else (0, 2, 1, 0, 3, 2)
            made += [[*(np.array(middle) + corners[at] * sides / 2), *normal] for at in order]
    return made


def ball(middle, radius, around, down):
    def corner(i, j):
        a, b = 2 * np.pi * i / around, np.pi * j / down
        normal = np.array([np.sin(b) * np.cos(a), np.cos(b), -np.sin(b) * np.sin(a)])
        return [*(np.array(middle) + radius * normal), *normal]

    cells = [(i, j) for j in range(down) for i in range(around)]
    made = [corner(*at) for i, j in cells if j < down - 1 for at in ((i, j), (i, j + 1), (i + 1, j + 1))]
    return made + [corner(*at) for i, j in cells if j > 0 for at in ((i, j), (i + 1, j + 1), (i + 1, j))]


pygame.display.init()
for attribute, value in [
    (pygame.GL_CONTEXT_MAJOR_VERSION, 4),
    (pygame.GL_CONTEXT_MINOR_VERSION, 5),
    (pygame.GL_CONTEXT_PROFILE_MASK, pygame.GL_CONTEXT_PROFILE_CORE),
    (pygame.GL_DEPTH_SIZE, 24),
]:
    pygame.display.gl_set_attribute(attribute, value)
pygame.display.set_mode((width, height), pygame.OPENGL | pygame.DOUBLEBUF)


def program(vertex, fragment, geometry=None):
    made = glCreateProgram()
    stages = ((GL_VERTEX_SHADER, vertex), (GL_GEOMETRY_SHADER, geometry), (GL_FRAGMENT_SHADER, fragment))
    for kind, text in stages:
        if text:
            shader = glCreateShader(kind)
            glShaderSource(shader, text)
            glCompileShader(shader)
            glAttachShader(made, shader)
    glLinkProgram(made)
    return made


def plain_texture(kind, format, layers=1, side=texels):
    made = glGenTextures(1)
    glBindTexture(kind, made)
    if kind == GL_TEXTURE_2D_ARRAY:
        glTexStorage3D(kind, 1, format, side, side, layers)
    else:
        glTexStorage2D(kind, 1, format, side, side)
    for parameter in (GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER):
        glTexParameteri(kind, parameter, GL_NEAREST)
    for parameter in (GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R):
        glTexParameteri(kind, parameter, GL_CLAMP_TO_EDGE)
    return made


def set_matrices(of, name, matrices):
    values = np.array(matrices, np.float32)
    glUniformMatrix4fv(glGetUniformLocation(of, name), len(matrices), GL_TRUE, values)


def mesh(vertices):
    values = np.array(vertices, np.float32)
    array = glGenVertexArrays(1)
    glBindVertexArray(array)
    glBindBuffer(GL_ARRAY_BUFFER, glGenBuffers(1))
    glBufferData(GL_ARRAY_BUFFER, values.nbytes, values, GL_STATIC_DRAW)
    for location in range(2):
        glEnableVertexAttribArray(location)
        glVertexAttribPointer(location, 3, GL_FLOAT, GL_FALSE, 24, ctypes.c_void_p(12 * location))
    return array, len(vertices)


LARGER = 2
meshes = [
    mesh(box((0, -0.25, 0), np.array((30, 0.5, 30)))),
    mesh(box((-4, 2.6, -2), np.array((3, 5, 3)))),
    mesh(ball((3, 2.2, 0), 1.6, 24, 12)),
    mesh(ball((0, 1.5, 4), 0.9, 40, 20)),
]


def draw(casters_only=False):
    for index, (array, count) in enumerate(meshes):
        if not (casters_only and options.left_out and index == LARGER):
            glBindVertexArray(array)
            glDrawArrays(GL_TRIANGLES, 0, count)


eye, target, up, degrees, near = (6.0, 12.0, 18.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), 45.0, 0.5
view = look_at(eye, target, up)
camera = perspective(degrees, width / height, near, 100.0) @ view
ends = (18.0, 24.0, 45.0)
lamps = {"cube": (1.5, 7.0, 2.0, 1.0), "cascades": (8.0, 14.0, 6.0, 0.0), "moments": (8.0, 14.0, 6.0, 1.0)}
light = lamps[options.kind]


def faces_of_cube():
    sides = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    ups = [(0, -1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (0, -1, 0), (0, -1, 0)]
    return [
        perspective(90, 1, 0.2, far) @ look_at(light[:3], np.add(light[:3], side), above)
        for side, above in zip(sides, ups)
    ]


def fitted_cascades():
    """A parallel view for each part of the eye's: as wide as the part, and with all that may cast into it."""
    turned = look_at(normalized(light[:3]), (0, 0, 0), (0, 1, 0))
    fitted = []
    for first, last in zip((near, *ends), ends):
        part = np.linalg.inv(perspective(degrees, width / height, first, last) @ view)
        corners = [part @ (x, y, z, 1) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        corners = np.array([turned[:3, :3] @ (corner[:3] / corner[3]) for corner in corners])
        low, high = corners.min(0), corners.max(0)
        # Casters stand before the part, as the light sees it.
        high[2] = max(high[2], 20.0)
        low[2] = high[2] - options.far if options.far else min(low[2], -20.0)
        around = np.eye(4)
        around[:3, :3] = turned[:3, :3]
        fitted.append(parallel(low, high) @ around)
    return fitted


views = {
    "cube": faces_of_cube,
    "cascades": fitted_cascades,
    "moments": lambda: [perspective(70, 1, 1.0, far) @ look_at(light[:3], (0, 0, 0), up)],
}[options.kind]()

kind, format, layers = {
    "cube": (GL_TEXTURE_CUBE_MAP, GL_DEPTH_COMPONENT32F, 6),
    "cascades": (GL_TEXTURE_2D_ARRAY if options.place == "layers" else GL_TEXTURE_2D, GL_DEPTH_COMPONENT24, len(views)),
    "moments": (GL_TEXTURE_2D, GL_RG32F, 1),
}[options.kind]
held = plain_texture(kind, format, layers, 2 * texels if options.place == "atlas" else texels)
# Those of further cascades, where each has its own.
others = [plain_texture(kind, format) for _ in views[1:]] if options.place == "textures" else []
framebuffer = glGenFramebuffers(1)
glBindFramebuffer(GL_FRAMEBUFFER, framebuffer)
if options.kind == "moments":
    tested = glGenRenderbuffers(1)
    glBindRenderbuffer(GL_RENDERBUFFER, tested)
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, texels, texels)
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, tested)
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, held, 0)
else:
    glDrawBuffer(GL_NONE)
    glReadBuffer(GL_NONE)
if options.kind == "cube":
    glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, held, 0)

# Where the moments go when they are blurred: along one side, and along both.
blurred = [plain_texture(kind, format) for _ in range(2)] if options.kind == "moments" and options.blur else []
blurring = [glGenFramebuffers(1) for _ in blurred]
for target_of, texture in zip(blurring, blurred):
    glBindFramebuffer(GL_FRAMEBUFFER, target_of)
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture, 0)
blur, nothing = program(CORNERS, BLUR), glGenVertexArrays(1)
lit = program(MESH, LIT % ARRIVING[options.kind])
filling = {
    "cube": lambda: program(PLACE, DISTANCE, SIX_LAYERS),
    "cascades": lambda: program(MESH, DEPTH),
    "moments": lambda: program(MESH, MOMENTS),
}[options.kind]()


def fill():
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer)
    glViewport(0, 0, texels, texels)
    glUseProgram(filling)
    # Farther than all there is.
    glClearColor(1, 1, 1, 1)
    if options.kind == "cube":
        glClear(GL_DEPTH_BUFFER_BIT)
        set_matrices(filling, "faces", views)
        glUniform3f(glGetUniformLocation(filling, "light"), *light[:3])
        glUniform1f(glGetUniformLocation(filling, "far"), far)
        return draw(casters_only=True)
    for layer, clip in enumerate(views):
        if options.kind == "cascades" and options.place == "layers":
            glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, held, 0, layer)
        elif options.kind == "cascades":
            glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, [held, *others][layer] if others else held, 0)
        if options.place == "atlas":
            glViewport(layer % 2 * texels, layer // 2 * texels, texels, texels)
        if options.place != "atlas" or layer == 0:
            glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)
        set_matrices(filling, "clip_from_world", [clip])
        draw(casters_only=True)


def blur_moments():
    glUseProgram(blur)
    glBindVertexArray(nothing)
    glDisable(GL_DEPTH_TEST)
    for target_of, source, along in zip(blurring, [held, *blurred], ((1, 0), (0, 1))):
        glBindFramebuffer(GL_FRAMEBUFFER, target_of)
        glBindTexture(kind, source)
        glUniform2i(glGetUniformLocation(blur, "along"), *along)
        glDrawArrays(GL_TRIANGLES, 0, 3)
    glEnable(GL_DEPTH_TEST)


def show():
    glBindFramebuffer(GL_FRAMEBUFFER, 0)
    for unit, texture in enumerate([blurred[-1] if blurred else held, *others]):
        glActiveTexture(GL_TEXTURE0 + unit)
        glBindTexture(kind, texture)
    glActiveTexture(GL_TEXTURE0)
    glViewport(0, 0, width, height)
    glClearColor(0.1, 0.1, 0.3, 1)
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)
    glUseProgram(lit)
    for unit, name in enumerate(("second", "third") if others else (), 1):
        glUniform1i(glGetUniformLocation(lit, name), unit)
    set_matrices(lit, "clip_from_world", [camera])
    set_matrices(lit, "view", [view])
    set_matrices(lit, "maps", views[:3])
    glUniform4f(glGetUniformLocation(lit, "light"), *light)
    glUniform3f(glGetUniformLocation(lit, "ends"), *ends)
    glUniform1f(glGetUniformLocation(lit, "far"), far)
    glUniform1f(glGetUniformLocation(lit, "bias"), options.bias)
    draw()


said = "version %s\nlight %s\ncamera %s\n" % (
    glGetString(GL_VERSION).decode().split()[0],
    " ".join(map(repr, light)),
    " ".join(map(repr, (*eye, *target, *up, degrees))),
)
if options.kind == "cube":
    said += "distance %r\n" % far
print(said, end="", flush=True)
if options.say:
    with open(options.say, "w") as file:
        file.write(said)
glEnable(GL_DEPTH_TEST)
for _ in range(100):
    fill()
    blur_moments()
    show()
    pygame.display.flip()
