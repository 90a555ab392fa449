// Camera with parallel projection.

const $ = id => document.getElementById(id);

class View {
  constructor(box) {
    this.box = box;
    const canvas = $("canvas");
    // Looks along the shortest side of the box. The longest is horizontal, or vertical on an upright canvas.
    const side = add(box.high, box.low, -1), order = [0, 1, 2].sort((a, b) => side[a] - side[b]);
    const axis = k => [0, 1, 2].map(i => Number(i === k));
    this.towards = axis(order[0]);
    const isUpright = canvas.clientHeight > canvas.clientWidth && side[order[2]] > 1.3 * side[order[1]];
    this.up = axis(order[isUpright ? 2 : 1]);
    if (order[0] === 1) this.towards = [0, -1, 0];
    this.right = cross(this.up, this.towards);
    this.centre = box.centre;
    this.zoom = 1;
    // Factor of simplification during motion; 1 is full detail.
    this.coarsening = 1;
  }

  /** Pixels per unit of length. */
  get scale() {
    const { width, height } = $("canvas"), side = add(this.box.high, this.box.low, -1);
    const extent = axis => Math.abs(axis[0] * side[0]) + Math.abs(axis[1] * side[1]) + Math.abs(axis[2] * side[2]);
    const first = this.first ||= [extent(this.right), extent(this.up)];
    return 0.92 * this.zoom * Math.min(width / (first[0] || 1), height / (first[1] || 1));
  }

  /** Half the depth range. */
  get reach() { return 1.05 * this.box.radius + Math.hypot(...add(this.centre, this.box.centre, -1)); }

  get matrix() {
    const { width, height } = $("canvas"), s = this.scale, { reach } = this;
    const rows = [this.right.map(x => 2 * s * x / width), this.up.map(x => 2 * s * x / height), this.towards.map(x => -x / reach)];
    const shift = rows.map(row => -dot(row, this.centre));
    return new Float32Array([...[0, 1, 2].flatMap(k => [rows[0][k], rows[1][k], rows[2][k], 0]), ...shift, 1]);
  }

  get rotation() { return new Float32Array([0, 1, 2].flatMap(k => [this.right[k], this.up[k], this.towards[k]])); }

  isVisible(box) {
    const v = add(box.centre, this.centre, -1), r = box.radius, s = this.scale;
    return Math.abs(dot(v, this.right)) - r < $("canvas").width / 2 / s && Math.abs(dot(v, this.up)) - r < $("canvas").height / 2 / s;
  }

  rotate(dx, dy) {
    const spin = (v, axis, angle) => {
      const [c, s] = [Math.cos(angle), Math.sin(angle)], w = cross(axis, v), along = dot(axis, v) * (1 - c);
      return [0, 1, 2].map(k => v[k] * c + w[k] * s + axis[k] * along);
    };
    this.towards = unit(spin(spin(this.towards, this.up, -dx), this.right, -dy));
    this.up = unit(spin(this.up, this.right, -dy));
    this.right = unit(cross(this.up, this.towards));
    this.up = cross(this.towards, this.right);
  }

  pan(dx, dy) {
    this.centre = add(add(this.centre, this.right, -dx / this.scale), this.up, dy / this.scale);
  }

  /** Zooms about a pixel relative to the middle of the canvas. */
  zoomBy(factor, dx = 0, dy = 0) {
    this.pan(-dx, -dy);
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.2), 1e5);
    this.pan(dx, dy);
  }

  reset() { Object.assign(this, new View(this.box), { first: undefined }); }

  /** Position of a pixel relative to the centre, at a depth between 0 and 1. */
  position(dx, dy, depth) {
    const across = add(add(this.centre, this.right, dx / this.scale), this.up, -dy / this.scale);
    return add(across, this.towards, (1 - 2 * depth) * this.reach);
  }
}
