// Tetrahedra cut by a plane: those with corners on both sides.

class Tets {
  constructor(gl, array) {
    this.gl = gl;
    const { grid } = facts.tets;
    this.points = Float64Array.from(array("tetPosition"), (x, i) => grid.origin[i % 3] + grid.step * x);
    this.tets = array("tet");
    this.blocks = array("tetBlock");
    this.behind = new Float64Array(this.points.length / 3);
    this.count = 0;
    this.made = gl.createVertexArray();
    this.edges = gl.createVertexArray();
  }

  /** Finds the tetrahedra cut by a plane, and fills the buffers with their faces. */
  cut([x, y, z, w], colourOf) {
    const { points, tets, behind } = this;
    for (let i = 0; i < behind.length; i++) behind[i] = w - x * points[3 * i] - y * points[3 * i + 1] - z * points[3 * i + 2];
    const found = [];
    for (let t = 0; t < tets.length; t += 4) {
      if (!isShown(this.blocks[t / 4])) continue;
      const n = (behind[tets[t]] >= 0) + (behind[tets[t + 1]] >= 0) + (behind[tets[t + 2]] >= 0) + (behind[tets[t + 3]] >= 0);
      if (n > 0 && n < 4) found.push(t);
    }
    // All faces are drawn; the depth test hides faces between two cut tetrahedra.
    const SIDES = [1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1];
    const place = new Float32Array(36 * found.length), normal = new Int8Array(48 * found.length);
    const colour = new Uint8Array(48 * found.length), lines = new Uint32Array(24 * found.length);
    const lengths = new Float32Array(12 * found.length);
    const at = v => [points[3 * v], points[3 * v + 1], points[3 * v + 2]];
    found.forEach((t, i) => {
      const corners = [0, 1, 2, 3].map(k => at(tets[t + k]));
      const own = colourOf(this.blocks[t / 4], corners);
      for (let side = 0; side < 4; side++) {
        const [a, b, c] = [0, 1, 2].map(k => corners[SIDES[3 * side + k]]);
        const length = [[a, b], [b, c], [c, a]].reduce((sum, [p, q]) => sum + Math.hypot(...add(q, p, -1)) / 3, 0);
        lengths.fill(length, 12 * i + 3 * side, 12 * i + 3 * side + 3);
        const n = unit(cross(add(b, a, -1), add(c, a, -1))).map(x => 127 * x);
        [a, b, c].forEach((p, k) => {
          const v = 12 * i + 3 * side + k;
          place.set(p, 3 * v);
          normal.set(n, 4 * v);
          colour.set(own, 4 * v);
          colour[4 * v + 3] = 255;
          lines[2 * v] = v;
          lines[2 * v + 1] = k === 2 ? v - 2 : v + 1;
        });
      }
    });
    const gl = this.gl;
    (this.buffers || []).forEach(b => gl.deleteBuffer(b));
    gl.bindVertexArray(this.made);
    const first = attribute(gl, 0, place, 3, gl.FLOAT, false);
    this.buffers = [first, attribute(gl, 1, normal, 4, gl.BYTE, true), attribute(gl, 2, colour, 4, gl.UNSIGNED_BYTE, true)];
    gl.bindVertexArray(this.edges);
    gl.bindBuffer(gl.ARRAY_BUFFER, first);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    this.buffers.push(attribute(gl, 1, lengths, 1, gl.FLOAT, false));
    this.buffers.push(buffer(gl, lines, gl.ELEMENT_ARRAY_BUFFER));
    gl.bindVertexArray(null);
    this.count = 12 * found.length;
  }

  draw(at, view) {
    if (this.count === 0) return;
    const gl = this.gl;
    gl.uniform3f(at.origin, 0, 0, 0);
    gl.uniform1f(at.size, 1);
    gl.uniform4f(at.cut, 0, 0, 0, 1);
    gl.uniform1f(at.flatness, 0);
    gl.vertexAttribI4ui(3, 0, 0, 0, 0);
    gl.bindVertexArray(this.made);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.drawArrays(gl.TRIANGLES, 0, this.count);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindVertexArray(this.edges);
    gl.vertexAttrib4f(2, 0.15, 0.15, 0.15, 1);
    drawFadingLines(gl, at, view, () => gl.drawElements(gl.LINES, 2 * this.count, gl.UNSIGNED_INT, 0));
  }
}

/** Radius ratio 3 r/R of a tetrahedron. */
function radiusRatio([a, b, c, d]) {
  const [u, v, w] = [b, c, d].map(p => add(p, a, -1));
  const [vw, wu, uv] = [cross(v, w), cross(w, u), cross(u, v)];
  const volume = dot(uv, w), length = x => Math.hypot(...x);
  const area = length(vw) + length(wu) + length(uv) + length(add(add(vw, wu), uv));
  const centre = length([0, 1, 2].map(k => vw[k] * dot(u, u) + wu[k] * dot(v, v) + uv[k] * dot(w, w)));
  return area * centre > 0 ? 6 * volume * Math.abs(volume) / (area * centre) : 0;
}
