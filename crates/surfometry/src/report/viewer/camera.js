// A parallel projection: lengths across the line of sight are true everywhere.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const combined = (a, s, b, t) => a.map((v, i) => s * v + t * b[i]);
const unitOf = a => { const length = Math.hypot(...a); return a.map(v => v / length); };
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

class Camera {
  constructor(view) {
    this.center = [0, 0, 0];
    this.halfHeight = 1;
    this.depth = 1;
    this.aspect = 1;
    this.look(view);
  }

  // From a named side.
  look({ right, up, toward }) {
    Object.assign(this, { right: [...right], up: [...up], toward: [...toward] });
  }

  // Turns what is seen to the right and down, in radians.
  turn(right, down) {
    const { up, toward } = this;
    this.toward = unitOf(combined(combined(toward, Math.cos(right), this.right, -Math.sin(right)), Math.cos(down), up, Math.sin(down)));
    this.right = unitOf(cross(up, this.toward));
    this.up = cross(this.toward, this.right);
  }

  // Moves what is seen, in mm.
  pan(right, up) {
    this.center = combined(combined(this.center, 1, this.right, -right), 1, this.up, -up);
  }

  // Zooms about a place in the picture, in shares of half its height from the middle.
  zoom(factor, [x, y] = [0, 0]) {
    const move = this.halfHeight * (1 - factor);
    this.center = combined(combined(this.center, 1, this.right, x * move), 1, this.up, y * move);
    this.halfHeight *= factor;
  }

  // The whole of some points in view, above a share of its height that is kept free.
  fit(meshes, free) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const axes = [this.right, this.up, this.toward];
    for (const { positions } of meshes) {
      for (let i = 0; i < positions.length; i += 3) {
        for (let a = 0; a < 3; a++) {
          const along = positions[i] * axes[a][0] + positions[i + 1] * axes[a][1] + positions[i + 2] * axes[a][2];
          if (along < low[a]) low[a] = along;
          if (along > high[a]) high[a] = along;
        }
      }
    }
    if (!(high[0] >= low[0])) return;
    const middle = low.map((v, a) => (v + high[a]) / 2), size = low.map((v, a) => high[a] - v);
    this.center = [0, 1, 2].map(w => axes.reduce((sum, axis, a) => sum + middle[a] * axis[w], 0));
    this.halfHeight = 0.54 * Math.max(size[1] / (1 - free), size[0] / this.aspect, 1e-6);
    this.center = combined(this.center, 1, this.up, -this.halfHeight * free);
    this.depth = 2 * Math.hypot(...size) + 1e-6;
  }

  // Column by column, for positions from `origin`.
  matrix(origin) {
    const { right, up, toward, halfHeight, aspect, depth } = this;
    const away = combined(this.center, 1, origin, -1);
    const rows = [[right, 1 / (halfHeight * aspect)], [up, 1 / halfHeight], [toward, -1 / (depth + halfHeight)]];
    const columns = [0, 1, 2].map(w => [...rows.map(([axis, scale]) => axis[w] * scale), 0]);
    return [...columns.flat(), ...rows.map(([axis, scale]) => -dot(axis, away) * scale), 1];
  }

  // Pixels from the upper left corner of a picture, and mm toward the viewer.
  project(point, width, height) {
    const away = combined(point, 1, this.center, -1), mm = 2 * this.halfHeight / height;
    return [width / 2 + dot(away, this.right) / mm, height / 2 - dot(away, this.up) / mm, dot(away, this.toward)];
  }
}
