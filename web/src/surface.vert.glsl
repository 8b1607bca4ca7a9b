attribute vec2 uv1;  // the place on the page, (0, 0) its upper left corner
#ifdef HAS_COLOR
attribute vec4 color;
#endif

uniform mat3 map_from_uv;

varying vec2 page_uv;
varying vec2 map_uv;
varying vec3 normal_ws;
varying vec4 tint;

void main() {
    page_uv = uv1;
    map_uv = (map_from_uv * vec3(uv, 1.0)).xy;
    normal_ws = transpose(inverse(mat3(modelMatrix))) * normal;
    tint = vec4(1.0);
#ifdef HAS_COLOR
    tint = color;
#endif
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
