// What the page holds of an object's surface and slices: quantised, as differences, deflated (report/packed.rs).

const MISSING = 65535;

function decoded(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflated(text) {
  const stream = new Blob([decoded(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function integers(bytes, packed) {
  const { offset, count, bytes: planes } = packed;
  if (planes === 1) return bytes.subarray(offset, offset + count);
  const found = new Uint32Array(count);
  let last = 0;
  for (let i = 0; i < count; i++) {
    let coded = 0;
    for (let plane = 0; plane < planes; plane++) coded |= bytes[offset + plane * count + i] << (8 * plane);
    last += (coded >>> 1) ^ -(coded & 1);
    found[i] = last;
  }
  return found;
}

// NaN where there is no value.
function numbers(bytes, quantised) {
  const { low, step, values } = quantised;
  return Float32Array.from(integers(bytes, values), whole => whole === MISSING ? NaN : low + step * whole);
}

// A normal from its place on an octahedron, as signed bytes.
function directions(bytes, packed) {
  const places = integers(bytes, packed);
  const found = new Int8Array(places.length / 2 * 3);
  for (let i = 0; 2 * i < places.length; i++) {
    let x = places[2 * i] / 127.5 - 1, y = places[2 * i + 1] / 127.5 - 1;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * Math.sign(x), (1 - Math.abs(x)) * Math.sign(y)];
    const length = 127 / Math.hypot(x, y, z);
    found.set([x * length, y * length, z * length], 3 * i);
  }
  return found;
}

// The scene of an object; null where it has none.
async function unpackedScene(number) {
  const holder = document.getElementById("scene-" + (number + 1));
  if (!holder) return null;
  const all = await inflated(holder.textContent);
  const length = new DataView(all.buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(all.subarray(4, 4 + length)));
  const bytes = all.subarray(4 + length);
  const axes = head.positions.map(axis => numbers(bytes, axis));
  const count = axes[0].length;
  const positions = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) for (let a = 0; a < 3; a++) positions[3 * i + a] = axes[a][i];
  const mesh = { positions, normals: directions(bytes, head.normals), triangles: integers(bytes, head.triangles) };
  return { head, bytes, mesh, count, areas: vertexAreas(mesh) };
}

// A third of the area of the triangles around each vertex.
function vertexAreas({ positions, triangles }) {
  const areas = new Float32Array(positions.length / 3);
  const difference = (a, b, axis) => positions[3 * b + axis] - positions[3 * a + axis];
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]];
    const [ux, uy, uz] = [0, 1, 2].map(axis => difference(a, b, axis));
    const [vx, vy, vz] = [0, 1, 2].map(axis => difference(a, c, axis));
    const third = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 6;
    areas[a] += third; areas[b] += third; areas[c] += third;
  }
  return areas;
}

function toWorld({ linear, origin }, voxel) {
  return origin.map((o, w) => o + linear[w][0] * voxel[0] + linear[w][1] * voxel[1] + linear[w][2] * voxel[2]);
}
