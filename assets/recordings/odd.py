"""OpenGL as few programs use it, so that nothing of it is read the wrong way round.

    xvfb-run -a stencilscope record --python /usr/bin/python3 --list -- /usr/bin/python3 odd.py

Into a window of 24 bits of depth and 8 of stencil: instances, a strip and a fan that start again, clip space with its
origin at the top, a scissor, a viewport of its own with depth turned round, all stencil operations with masks.
Into textures: depth as a float with stencil, of an odd size; the faces of a cube; four samples.

Debian: python3-pygame python3-opengl.
"""

import ctypes

import pygame
from OpenGL.GL import *

WIDTH, HEIGHT = 320, 240
VERTEX = """#version 330 core
uniform float turn;
void main() {
    vec2 at[6] = vec2[](vec2(-.8, -.8), vec2(.1, -.7), vec2(-.7, .2), vec2(.15, .1), vec2(-.3, .9), vec2(.6, .5));
    vec2 p = at[gl_VertexID % 6] + vec2(.3, .1) * gl_InstanceID;
    p = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * p;
    gl_Position = vec4(p * 1.5, .5 * p.y + .2 * gl_InstanceID - .1 * gl_VertexID, 1.5 + .4 * p.x);
}"""
FRAGMENT = """#version 330 core
out vec4 color;
void main() { color = vec4(1., .5, 0., 1.); }"""

pygame.init()
for attribute, value in [
    (pygame.GL_CONTEXT_MAJOR_VERSION, 4),
    (pygame.GL_CONTEXT_MINOR_VERSION, 5),
    (pygame.GL_CONTEXT_PROFILE_MASK, pygame.GL_CONTEXT_PROFILE_CORE),
    (pygame.GL_DEPTH_SIZE, 24),
    (pygame.GL_STENCIL_SIZE, 8),
]:
    pygame.display.gl_set_attribute(attribute, value)
pygame.display.set_mode((WIDTH, HEIGHT), pygame.OPENGL | pygame.DOUBLEBUF)

program = glCreateProgram()
for kind, text in ((GL_VERTEX_SHADER, VERTEX), (GL_FRAGMENT_SHADER, FRAGMENT)):
    shader = glCreateShader(kind)
    glShaderSource(shader, text)
    glCompileShader(shader)
    glAttachShader(program, shader)
glLinkProgram(program)
glUseProgram(program)
turn = glGetUniformLocation(program, "turn")
glBindVertexArray(glGenVertexArrays(1))
RESTART = 0xFFFF
indices = [0, 1, 2, 3, RESTART, 2, 3, 4, 5, RESTART, 4, 1]
glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, glGenBuffers(1))
glBufferData(GL_ELEMENT_ARRAY_BUFFER, (ctypes.c_uint16 * len(indices))(*indices), GL_STATIC_DRAW)


def target(kind, format, size, samples=0):
    texture = glGenTextures(1)
    glBindTexture(kind, texture)
    if samples:
        glTexStorage2DMultisample(kind, samples, format, *size, True)
    else:
        glTexStorage2D(kind, 1, format, *size)
    return texture


def framebuffer():
    made = glGenFramebuffers(1)
    glBindFramebuffer(GL_FRAMEBUFFER, made)
    glDrawBuffer(GL_NONE)
    return made


odd = framebuffer()
glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, target(GL_TEXTURE_2D, GL_DEPTH32F_STENCIL8, (101, 53)), 0)
cube = target(GL_TEXTURE_CUBE_MAP, GL_DEPTH_COMPONENT16, (64, 64))
faces = framebuffer()
many = framebuffer()
samples = target(GL_TEXTURE_2D_MULTISAMPLE, GL_DEPTH24_STENCIL8, (64, 64), 4)
glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_TEXTURE_2D_MULTISAMPLE, samples, 0)


def clear(framebuffer, size, depth=0.8, stencil=3):
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer)
    glViewport(0, 0, *size)
    glDepthRange(0, 1)
    glDisable(GL_SCISSOR_TEST)
    glDisable(GL_CULL_FACE)
    glStencilMask(0xFF)
    glClearDepth(depth)
    glClearStencil(stencil)
    glClear((GL_COLOR_BUFFER_BIT if framebuffer == 0 else 0) | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT)


def counting():
    glEnable(GL_STENCIL_TEST)
    glStencilFuncSeparate(GL_FRONT, GL_ALWAYS, 0x55, 0xFF)
    glStencilFuncSeparate(GL_BACK, GL_NOTEQUAL, 4, 0x0F)
    glStencilMaskSeparate(GL_BACK, 0x7F)
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_INVERT, GL_INCR_WRAP)
    glStencilOpSeparate(GL_BACK, GL_DECR, GL_DECR_WRAP, GL_REPLACE)


def window():
    clear(0, (WIDTH, HEIGHT))
    glEnable(GL_PRIMITIVE_RESTART_FIXED_INDEX)
    glUniform1f(turn, 0.1)
    counting()
    glDrawElementsInstanced(GL_TRIANGLE_STRIP, len(indices), GL_UNSIGNED_SHORT, None, 3)
    glEnable(GL_SCISSOR_TEST)
    glScissor(20, 30, 200, 180)
    glUniform1f(turn, 0.7)
    glDrawElements(GL_TRIANGLE_FAN, len(indices), GL_UNSIGNED_SHORT, None)
    glDisable(GL_PRIMITIVE_RESTART_FIXED_INDEX)
    # y down, z from 0, near and far turned round, clockwise fronts, backs left out.
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE)
    glViewport(40, 20, 200, 150)
    glDepthRange(0.9, 0.1)
    glEnable(GL_CULL_FACE)
    glFrontFace(GL_CW)
    glUniform1f(turn, 0.3)
    glDrawArraysInstanced(GL_TRIANGLES, 0, 6, 2)
    glFrontFace(GL_CCW)
    glDrawArraysInstanced(GL_TRIANGLES, 0, 6, 2)
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE)


def textures():
    clear(odd, (101, 53))
    glUniform1f(turn, 0.2)
    counting()
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 6)
    glDisable(GL_STENCIL_TEST)
    for face in (1, 4):
        glBindFramebuffer(GL_FRAMEBUFFER, faces)
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, cube, 0)
        clear(faces, (64, 64))
        glUniform1f(turn, face)
        glEnable(GL_DEPTH_CLAMP)
        glDrawArrays(GL_TRIANGLES, 0, 6)
        glDisable(GL_DEPTH_CLAMP)
    clear(many, (64, 64))
    glDrawArrays(GL_TRIANGLES, 0, 6)


glEnable(GL_DEPTH_TEST)
glDepthFunc(GL_LESS)
for _ in range(30):
    textures()
    window()
    pygame.display.flip()
