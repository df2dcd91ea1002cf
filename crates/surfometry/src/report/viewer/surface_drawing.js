// Surfaces with WebGL 2, and which vertex or object is seen where.

const VERTEX_SHADER = `#version 300 es
in vec3 position; in vec3 normal; in float value; in float marked;
uniform mat4 view;
uniform float size;
out vec3 n; out float v; out float m; flat out int vertex;
void main() {
  gl_Position = view * vec4(position, 1.0);
  gl_PointSize = size;
  n = normal; v = value; m = marked; vertex = gl_VertexID;
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 n; in float v; in float m; flat in int vertex;
uniform vec3 right; uniform vec3 up; uniform vec3 toward;
uniform sampler2D table;
uniform vec2 limits; uniform vec4 solid; uniform vec3 missing;
uniform int mode; uniform int part; uniform bool dimmed;
out vec4 color;
vec4 code(int number) {
  return vec4(number & 255, (number >> 8) & 255, (number >> 16) & 255, (number >> 24) & 255) / 255.0;
}
void main() {
  if (mode == 1) { color = code(vertex + 1); return; }
  if (mode == 2) { color = code(part + 1); return; }
  if (mode == 3) {
    vec2 rim = abs(gl_PointCoord - 0.5);
    color = vec4(max(rim.x, rim.y) > 0.38 ? solid.rgb * 0.62 : solid.rgb, 1.0);
    return;
  }
  vec3 base = solid.a > 0.0 ? solid.rgb
    : v > 1e37 ? missing : texture(table, vec2((v - limits.x) / (limits.y - limits.x), 0.5)).rgb;
  if (dimmed && m < 0.5) base = mix(base, vec3(0.93), 0.86);
  vec3 seen = normalize(vec3(dot(n, right), dot(n, up), dot(n, toward)));
  if (seen.z < 0.0) seen = -seen;
  float light = 0.52 + 0.4 * max(dot(seen, normalize(vec3(-0.35, 0.5, 0.79))), 0.0) + 0.1 * seen.z;
  float gloss = 0.1 * pow(max(dot(seen, normalize(vec3(-0.2, 0.28, 0.94))), 0.0), 24.0);
  color = vec4(base * light + gloss, 1.0);
}`;

const NOTHING = 3e38;

class SurfaceDrawing {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("This browser has no WebGL 2, so the surface cannot be shown.");
    this.program = linked(gl);
    this.parts = [];
    this.clouds = [];
    this.origin = null;
    this.table = gl.createTexture();
    this.limits = [0, 1];
    this.dimmed = false;
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(1, 1, 1, 1);
  }

  uniform(name) {
    return this.gl.getUniformLocation(this.program, name);
  }

  // Positions are kept near to 0, where they have all their digits.
  placed(positions) {
    this.origin ??= [...positions.subarray(0, 3)];
    return positions.map((v, i) => v - this.origin[i % 3]);
  }

  addPart(mesh, solid = null) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute("position", this.placed(mesh.positions), 3, gl.FLOAT);
    this.attribute("normal", mesh.normals, 3, gl.BYTE, true);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles, gl.STATIC_DRAW);
    const part = { array, count: mesh.triangles.length, solid, shown: true, buffers: {} };
    gl.bindVertexArray(null);
    this.parts.push(part);
    return part;
  }

  // Voxels as squares of a size in mm.
  addCloud(positions, color, size) {
    const array = this.gl.createVertexArray();
    this.gl.bindVertexArray(array);
    this.attribute("position", this.placed(positions), 3, this.gl.FLOAT);
    this.gl.bindVertexArray(null);
    const cloud = { array, count: positions.length / 3, color, size, shown: true };
    this.clouds.push(cloud);
    return cloud;
  }

  attribute(name, data, size, type, normalised = false, buffer = this.gl.createBuffer()) {
    const gl = this.gl, place = gl.getAttribLocation(this.program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, type, normalised, 0, 0);
    return buffer;
  }

  setOfPart(part, name, data, type) {
    this.gl.bindVertexArray(part.array);
    part.buffers[name] = this.attribute(name, data, 1, type, false, part.buffers[name]);
    this.gl.bindVertexArray(null);
  }

  setValues(part, values) {
    this.setOfPart(part, "value", values.map(value => Number.isNaN(value) ? NOTHING : value), this.gl.FLOAT);
  }

  setMarks(part, marks) {
    this.setOfPart(part, "marked", marks, this.gl.UNSIGNED_BYTE);
  }

  setScale(scale, limits) {
    const gl = this.gl;
    this.limits = limits;
    gl.bindTexture(gl.TEXTURE_2D, this.table);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colorTable(scale));
    for (const [name, value] of [["MIN_FILTER", "LINEAR"], ["MAG_FILTER", "LINEAR"], ["WRAP_S", "CLAMP_TO_EDGE"], ["WRAP_T", "CLAMP_TO_EDGE"]]) {
      gl.texParameteri(gl.TEXTURE_2D, gl["TEXTURE_" + name], gl[value]);
    }
  }

  // Sets what all parts share, and clears the picture.
  prepare(camera, mode) {
    const gl = this.gl, { width, height } = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...(mode ? [0, 0, 0, 0] : [1, 1, 1, 1]));
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.uniformMatrix4fv(this.uniform("view"), false, camera.matrix(this.origin ?? [0, 0, 0]));
    for (const axis of ["right", "up", "toward"]) gl.uniform3fv(this.uniform(axis), camera[axis]);
    gl.uniform2fv(this.uniform("limits"), this.limits);
    gl.uniform3fv(this.uniform("missing"), NO_VALUE.map(c => c / 255));
    gl.uniform1i(this.uniform("dimmed"), this.dimmed ? 1 : 0);
    gl.uniform1i(this.uniform("mode"), mode);
    gl.bindTexture(gl.TEXTURE_2D, this.table);
  }

  drawParts() {
    const gl = this.gl;
    this.parts.forEach((part, number) => {
      if (!part.shown) return;
      gl.uniform1i(this.uniform("part"), number);
      gl.uniform4fv(this.uniform("solid"), part.solid ? [...part.solid.map(c => c / 255), 1] : [0, 0, 0, 0]);
      gl.bindVertexArray(part.array);
      gl.drawElements(gl.TRIANGLES, part.count, gl.UNSIGNED_INT, 0);
    });
    gl.bindVertexArray(null);
  }

  draw(camera) {
    const gl = this.gl;
    this.prepare(camera, 0);
    this.drawParts();
    gl.uniform1i(this.uniform("mode"), 3);
    for (const cloud of this.clouds.filter(cloud => cloud.shown)) {
      gl.uniform4fv(this.uniform("solid"), [...cloud.color.map(c => c / 255), 1]);
      gl.uniform1f(this.uniform("size"), Math.max(3, cloud.size * this.canvas.height / (2 * camera.halfHeight)));
      gl.bindVertexArray(cloud.array);
      gl.drawArrays(gl.POINTS, 0, cloud.count);
    }
    gl.bindVertexArray(null);
  }

  // The numbers, from 1, of what is seen in each pixel of a box (rows from below): of vertices, or of parts.
  seen(camera, what, [x, y, width, height]) {
    const gl = this.gl;
    const target = this.target();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    this.prepare(camera, what === "vertices" ? 1 : 2);
    this.drawParts();
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(x, y, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return new Uint32Array(pixels.buffer);
  }

  // A picture beside the visible one, of its size.
  target() {
    const gl = this.gl, { width, height } = this.canvas;
    if (this.hidden?.width === width && this.hidden.height === height) return this.hidden.frame;
    const frame = gl.createFramebuffer(), color = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    for (const [buffer, format, place] of [[color, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
    this.hidden = { frame, width, height };
    return frame;
  }

  // A browser holds few contexts.
  release() {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

function linked(gl) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}
