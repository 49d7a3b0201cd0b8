/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * OpenGL's and EGL's functions, by libepoxy. gl_load_functions() loads it when it is needed. glClear() calls a variable
 * epoxy_glClear, which is our own and which the linker knows by another name than libepoxy's. */
#ifndef CONUS_RENDER_GL_FUNCTIONS_H
#define CONUS_RENDER_GL_FUNCTIONS_H

#include "base/library.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

/* clang-format off */
#define GL_FUNCTIONS(F)                                                                                                \
    F(epoxy_, eglBindAPI) F(epoxy_, eglCreateContext) F(epoxy_, eglDestroyContext) F(epoxy_, eglGetCurrentContext)     \
    F(epoxy_, eglGetCurrentDisplay) F(epoxy_, eglGetCurrentSurface) F(epoxy_, eglGetError)                             \
    F(epoxy_, eglGetPlatformDisplayEXT) F(epoxy_, eglInitialize) F(epoxy_, eglMakeCurrent) F(epoxy_, eglQueryAPI)      \
    F(epoxy_, eglQueryDeviceStringEXT) F(epoxy_, eglQueryDevicesEXT) F(epoxy_, eglQueryString)                         \
    F(epoxy_, glAttachShader) F(epoxy_, glBeginQuery) F(epoxy_, glBindBuffer) F(epoxy_, glBindBufferBase)              \
    F(epoxy_, glBindFramebuffer) F(epoxy_, glBindImageTexture) F(epoxy_, glBindTextureUnit) F(epoxy_, glBindTextures)  \
    F(epoxy_, glBindVertexArray) F(epoxy_, glBlendColor) F(epoxy_, glBlendFunc)                                        \
    F(epoxy_, glCheckNamedFramebufferStatus) F(epoxy_, glClearBufferfv) F(epoxy_, glClearBufferuiv)                    \
    F(epoxy_, glClientWaitSync) F(epoxy_, glClipControl) F(epoxy_, glColorMask) F(epoxy_, glCompileShader)             \
    F(epoxy_, glCopyImageSubData) F(epoxy_, glCopyNamedBufferSubData) F(epoxy_, glCreateBuffers)                       \
    F(epoxy_, glCreateFramebuffers) F(epoxy_, glCreateProgram) F(epoxy_, glCreateQueries) F(epoxy_, glCreateShader)    \
    F(epoxy_, glCreateTextures) F(epoxy_, glCreateVertexArrays) F(epoxy_, glCullFace)                                  \
    F(epoxy_, glDebugMessageCallback) F(epoxy_, glDebugMessageControl) F(epoxy_, glDebugMessageInsert)                 \
    F(epoxy_, glDeleteBuffers) F(epoxy_, glDeleteFramebuffers) F(epoxy_, glDeleteProgram) F(epoxy_, glDeleteQueries)   \
    F(epoxy_, glDeleteShader) F(epoxy_, glDeleteSync) F(epoxy_, glDeleteTextures) F(epoxy_, glDeleteVertexArrays)      \
    F(epoxy_, glDepthFunc) F(epoxy_, glDepthMask) F(epoxy_, glDisable) F(epoxy_, glDispatchCompute)                    \
    F(epoxy_, glDrawArrays) F(epoxy_, glDrawArraysInstancedBaseInstance) F(epoxy_, glDrawElementsIndirect)             \
    F(epoxy_, glDrawElementsInstanced) F(epoxy_, glEnable) F(epoxy_, glEnableVertexArrayAttrib) F(epoxy_, glEndQuery)  \
    F(epoxy_, glFenceSync) F(epoxy_, glFinish) F(epoxy_, glFlush) F(epoxy_, glGetError) F(epoxy_, glGetIntegerv)       \
    F(epoxy_, glGetNamedBufferSubData) F(epoxy_, glGetProgramInfoLog) F(epoxy_, glGetProgramiv)                        \
    F(epoxy_, glGetQueryObjectuiv) F(epoxy_, glGetShaderInfoLog) F(epoxy_, glGetShaderiv) F(epoxy_, glGetString)       \
    F(epoxy_, glGetTextureImage) F(epoxy_, glGetTextureSubImage) F(epoxy_, glGetUniformLocation)                       \
    F(epoxy_, glLinkProgram) F(epoxy_, glMapNamedBufferRange) F(epoxy_, glMemoryBarrier)                               \
    F(epoxy_, glMultiDrawElements) F(epoxy_, glNamedBufferData) F(epoxy_, glNamedBufferStorage)                        \
    F(epoxy_, glNamedBufferSubData) F(epoxy_, glNamedFramebufferDrawBuffers) F(epoxy_, glNamedFramebufferParameteri)   \
    F(epoxy_, glNamedFramebufferTexture) F(epoxy_, glPixelStorei) F(epoxy_, glPolygonMode)                             \
    F(epoxy_, glProvokingVertex) F(epoxy_, glScissor) F(epoxy_, glShaderSource) F(epoxy_, glTextureBuffer)             \
    F(epoxy_, glTextureParameteri) F(epoxy_, glTextureStorage2D) F(epoxy_, glTextureStorage3D)                         \
    F(epoxy_, glTextureSubImage2D) F(epoxy_, glTextureSubImage3D) F(epoxy_, glUniform1f) F(epoxy_, glUniform1i)        \
    F(epoxy_, glUniform1ui) F(epoxy_, glUniform2f) F(epoxy_, glUniform2fv) F(epoxy_, glUniform2i)                      \
    F(epoxy_, glUniform3dv) F(epoxy_, glUniform3f) F(epoxy_, glUniform3fv) F(epoxy_, glUniform3i)                      \
    F(epoxy_, glUniform3iv) F(epoxy_, glUniformMatrix2x3dv) F(epoxy_, glUniformMatrix3dv)                              \
    F(epoxy_, glUniformMatrix3fv) F(epoxy_, glUniformMatrix4dv) F(epoxy_, glUniformMatrix4fv) F(epoxy_, glUseProgram)  \
    F(epoxy_, glVertexArrayAttribBinding) F(epoxy_, glVertexArrayAttribFormat) F(epoxy_, glVertexArrayAttribIFormat)   \
    F(epoxy_, glVertexArrayBindingDivisor) F(epoxy_, glVertexArrayElementBuffer) F(epoxy_, glVertexArrayVertexBuffer)  \
    F(epoxy_, glViewport)
/* clang-format on */

#define GL_PRAGMA(words) _Pragma(#words)
#define GL_RENAME(prefix, name) GL_PRAGMA(redefine_extname prefix##name conus_##name)
GL_FUNCTIONS(GL_RENAME)

/** CONUS_ERROR_UNSUPPORTED without libepoxy. */
conus_status gl_load_functions(void);

#endif
