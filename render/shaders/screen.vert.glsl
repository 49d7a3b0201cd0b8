// One triangle over the whole viewport: glDrawArrays(GL_TRIANGLES, 0, 3), no attributes.
void main()
{
    gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
