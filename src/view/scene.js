// Scene: chunks of a wall or cones of a network, with their colours.

const WALL = 1;
const PALETTE = { wall: [206, 122, 110], inlet: [38, 101, 178], outlet: [236, 180, 64], inside: [238, 224, 198], unknown: [150, 150, 150] };
const OTHERS = [[38, 101, 178], [236, 180, 64], [62, 150, 110], [150, 96, 170], [90, 170, 205], [140, 140, 140]];
const QUALITY = [[165, 0, 38], [244, 109, 67], [254, 224, 139], [102, 189, 160], [40, 110, 170]];
const VIRIDIS = [[68, 1, 84], [71, 45, 123], [59, 82, 139], [44, 114, 142], [33, 145, 140], [40, 174, 128], [94, 201, 98],
  [173, 220, 48], [253, 231, 37]];

function interpolate(scale, share) {
  const at = Math.min(Math.max(share, 0), 1) * (scale.length - 1), i = Math.min(Math.floor(at), scale.length - 2);
  return [0, 1, 2].map(k => Math.round(scale[i][k] + (at - i) * (scale[i + 1][k] - scale[i][k])));
}

/** Colour of a code from 1 to `most`; 0 is a place without a value. */
const valueColour = (code, most) => code === 0 ? PALETTE.unknown : viridis((code - 1) / (most - 1));

const viridis = share => interpolate(VIRIDIS, 0.06 + 0.86 * share);

function blockColour(block) {
  const turn = (block * 0.618033988749895) % 1, value = 0.78 + 0.14 * ((block * 0.754877666) % 1);
  return [5, 3, 1].map(shift => {
    const k = (shift + 6 * turn) % 6;
    return Math.round(255 * value * (1 - 0.42 * Math.min(Math.max(Math.min(k, 4 - k), 0), 1)));
  });
}

const regions = new Map((facts.regions || []).map(region => [region.id, region]));
const REGIONS = { lumen: [186, 58, 54], wall: [232, 176, 140], annulus: [96, 168, 206], tissue: [168, 182, 170] };

/** Colour of a region: by its name, otherwise by its place in the list. */
function regionColour(id) {
  const { name } = regions.get(id) || { name: "" }, place = [...regions.keys()].indexOf(id);
  return (Object.hasOwn(REGIONS, name) && REGIONS[name]) || OTHERS[(place + OTHERS.length) % OTHERS.length];
}

/** True if a face of a region is shown: the region is, and the one beyond an interface is not, or the other way round. */
function isShown(region, patch) {
  if (regions.size === 0) return true;
  const on = id => !(regions.get(id) || {}).hidden, { beyond } = patches.get(patch) || {};
  return beyond == null ? on(region) : on(region) !== on(beyond);
}

const patches = new Map((facts.patches || []).map(patch => [patch.id, patch]));

/** Kind of a patch: wall, inlet, outlet or its own name. */
function patchKind(id) {
  const { name } = patches.get(id) || { name: `patch ${id}` };
  if (id === WALL || patches.size === 0) return "wall";
  return ["inlet", "outlet"].find(kind => name.startsWith(kind)) || name;
}

const patchColour = id => (Object.hasOwn(PALETTE, patchKind(id)) && PALETTE[patchKind(id)]) || OTHERS[Math.abs(id) % OTHERS.length];

/** Wall as chunks with vertex buffers; each group of faces has a block and a patch. */
class Walls {
  constructor(gl, array) {
    this.gl = gl;
    this.groups = { block: [], patch: [] };
    this.chunks = facts.wall.chunks.map((head, number) => this.chunk(head, number, array));
    this.triangles = this.chunks.reduce((sum, chunk) => sum + chunk.corners.length / 3, 0);
  }

  chunk(head, number, array) {
    const get = name => array(name + number), gl = this.gl;
    const position = Uint16Array.from(get("position")), corners = Uint32Array.from(get("corner"));
    const count = position.length / 3;
    const names = new Uint32Array(count), first = this.groups.block.length;
    const blocks = get("groupBlock"), kinds = get("groupPatch"), points = get("groupPoints"), faces = get("groupFaces");
    for (let g = 0, v = 0; g < blocks.length; g++) {
      this.groups.block.push(blocks[g]);
      this.groups.patch.push(kinds[g]);
      names.fill(first + g + 1, v, v += points[g]);
    }
    // Pieces from the widest to the thinnest, with cumulative counts of faces and lines.
    const pieces = get("pieceRadius"), ends = { faces: [0], lines: [0] };
    const ofPieces = get("pieceGroups"), linesOf = get("pieceLines");
    const lineNames = [];
    for (let p = 0, g = 0; p < pieces.length; p++) {
      let sum = 0;
      const group = first + g;
      for (let i = 0; i < ofPieces[p]; i++) sum += faces[g++];
      ends.faces.push(ends.faces[p] + 3 * sum);
      ends.lines.push(ends.lines[p] + 2 * linesOf[p]);
      for (let i = 0; i < 2 * linesOf[p]; i++) lineNames.push(group + 1);
    }
    const { origin, step } = head.grid;
    const line = Uint16Array.from(get("line"));
    const chunk = { names, corners, position, count, first, ends, origin, size: 65535 * step, line,
      radii: Float64Array.from(pieces, r => r / 16 * step), lineNames: Uint32Array.from(lineNames),
      all: { corners, ends: ends.faces, faces, groups: ofPieces },
      quality: get("quality"), radius: get("radius"), order: get("order"), value: get("value") };
    chunk.box = bounds(position, origin, step);
    const normals = vertexNormals(position, corners);
    chunk.faces = gl.createVertexArray();
    gl.bindVertexArray(chunk.faces);
    attribute(gl, 0, position, 3, gl.UNSIGNED_SHORT, true);
    attribute(gl, 1, normals, 4, gl.BYTE, true);
    chunk.colours = attribute(gl, 2, new Uint8Array(4 * count), 4, gl.UNSIGNED_BYTE, true);
    integerAttribute(gl, 3, names);
    chunk.elements = buffer(gl, corners, gl.ELEMENT_ARRAY_BUFFER);
    chunk.lines = gl.createVertexArray();
    gl.bindVertexArray(chunk.lines);
    attribute(gl, 0, line, 3, gl.UNSIGNED_SHORT, true);
    chunk.lineColours = attribute(gl, 2, new Uint8Array(4 * line.length / 3), 4, gl.UNSIGNED_BYTE, true);
    integerAttribute(gl, 3, chunk.lineNames);
    gl.bindVertexArray(null);
    return chunk;
  }

  /** Leaves out the faces of hidden regions. */
  show() {
    const gl = this.gl;
    for (const chunk of this.chunks) {
      const { all } = chunk, corners = new Uint32Array(all.corners.length), ends = [0];
      let [group, from, to] = [0, 0, 0];
      for (const groups of all.groups) {
        for (let i = 0; i < groups; i++, group++) {
          const next = from + 3 * all.faces[group], name = chunk.first + group;
          if (isShown(this.groups.block[name], this.groups.patch[name])) {
            corners.set(all.corners.subarray(from, next), to);
            to += next - from;
          }
          from = next;
        }
        ends.push(to);
      }
      chunk.corners = corners.slice(0, to);
      chunk.ends.faces = ends;
      gl.bindVertexArray(chunk.faces);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, chunk.elements);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, chunk.corners, gl.STATIC_DRAW);
      gl.bindVertexArray(null);
      if (chunk.edges) gl.deleteVertexArray(chunk.edges);
      chunk.edges = null;
    }
  }

  /** Colours the wall by patch, region, block, quality, radius, order or value. */
  colour(what) {
    const gl = this.gl;
    const most = facts.network ? facts.network.orders : 1;
    const orders = (() => { let m = 1; for (const c of this.chunks) for (const o of c.order) if (o > m) m = o; return m; })();
    const scale = (make, n = 256) => Array.from({ length: n }, (_, i) => make(i));
    const table = what === "quality" ? scale(q => interpolate(QUALITY, q / 255))
      : what === "radius" ? scale(r => viridis((r - 1) / 254))
      : what === "value" ? scale(v => valueColour(v, 255))
      : what === "order" ? scale(o => viridis(Math.max(orders, most) > 1 ? (o - 1) / (Math.max(orders, most) - 1) : 0.5)) : null;
    for (const chunk of this.chunks) {
      const of = what === "quality" ? chunk.quality : what === "radius" ? chunk.radius : what === "value" ? chunk.value : chunk.order;
      const ofGroup = name => what === "block" ? blockColour(this.groups.block[name - 1])
        : what === "region" ? regionColour(this.groups.block[name - 1])
        : what === "patch" ? patchColour(this.groups.patch[name - 1]) : PALETTE.wall;
      const paint = (names, pick) => {
        const out = new Uint8Array(4 * names.length);
        let last = 0, colour = null;
        for (let i = 0; i < names.length; i++) {
          if (table) colour = pick(i);
          else if (names[i] !== last) colour = ofGroup(last = names[i]);
          out.set(colour, 4 * i);
          out[4 * i + 3] = 255;
        }
        return out;
      };
      const ofVertex = paint(chunk.names, i => table[of[i]]);
      gl.bindBuffer(gl.ARRAY_BUFFER, chunk.colours);
      gl.bufferData(gl.ARRAY_BUFFER, ofVertex, gl.STATIC_DRAW);
      // Lines have the colour of the first point of their group.
      const firstOf = new Map();
      if (table) for (let v = 0; v < chunk.count; v++) if (!firstOf.has(chunk.names[v])) firstOf.set(chunk.names[v], v);
      const ofLines = paint(chunk.lineNames, i => table[of[firstOf.get(chunk.lineNames[i])]]);
      gl.bindBuffer(gl.ARRAY_BUFFER, chunk.lineColours);
      gl.bufferData(gl.ARRAY_BUFFER, ofLines, gl.STATIC_DRAW);
    }
  }

  /** Draws the visible chunks: wide pieces as faces, thin ones as lines. */
  draw(at, view, lined) {
    const gl = this.gl;
    for (const chunk of this.chunks) {
      if (!view.isVisible(chunk.box)) continue;
      gl.uniform3fv(at.origin, chunk.origin);
      gl.uniform1f(at.size, chunk.size);
      const wide = countAtLeast(chunk.radii, facts.wall.exact && view.coarsening === 1 ? 0 : 0.6 * view.coarsening / view.scale);
      gl.uniform1f(at.flatness, 0);
      gl.bindVertexArray(chunk.faces);
      const end = chunk.ends.faces[wide];
      if (end > 0) gl.drawElements(gl.TRIANGLES, end, gl.UNSIGNED_INT, 0);
      if (lined && end > 0) this.drawEdges(chunk, end, at, view);
      const [from, end_] = [chunk.ends.lines[wide], chunk.ends.lines[chunk.radii.length]];
      // During motion the thinnest pieces are omitted.
      const to = from + 2 * Math.ceil((end_ - from) / 2 / Math.max(view.coarsening / 4, 1));
      if (to > from) {
        gl.uniform1f(at.flatness, 2);
        gl.bindVertexArray(chunk.lines);
        gl.drawArrays(gl.LINES, from, to - from);
      }
    }
  }

  drawEdges(chunk, end, at, view) {
    const gl = this.gl;
    if (!chunk.edges) {
      const edges = new Uint32Array(2 * chunk.corners.length);
      for (let i = 0; i < chunk.corners.length; i++) {
        edges[2 * i] = chunk.corners[i];
        edges[2 * i + 1] = chunk.corners[i % 3 === 2 ? i - 2 : i + 1];
      }
      chunk.edges = gl.createVertexArray();
      gl.bindVertexArray(chunk.edges);
      attribute(gl, 0, chunk.position, 3, gl.UNSIGNED_SHORT, true);
      attribute(gl, 1, meanEdges(chunk), 1, gl.FLOAT, false);
      buffer(gl, edges, gl.ELEMENT_ARRAY_BUFFER);
    }
    gl.bindVertexArray(chunk.edges);
    gl.vertexAttrib4f(2, 0, 0, 0, 0.35);
    drawFadingLines(gl, at, view, () => gl.drawElements(gl.LINES, 2 * end, gl.UNSIGNED_INT, 0));
  }
}

/** Draws lines that fade out where edges, whose mean length is attribute 1, are short on the screen. */
function drawFadingLines(gl, at, view, draw) {
  gl.uniform1f(at.flatness, 2);
  gl.uniform1f(at.pixels, view.scale / Math.min(devicePixelRatio || 1, 2));
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  draw();
  gl.disable(gl.BLEND);
  gl.uniform1f(at.pixels, 0);
  gl.uniform1f(at.flatness, 0);
}

/** Mean edge length at each point of a chunk. */
function meanEdges({ position, corners, size }) {
  const sum = new Float32Array(position.length / 3), edges = new Uint32Array(sum.length);
  for (let i = 0; i < corners.length; i++) {
    const v = corners[i], w = corners[i % 3 === 2 ? i - 2 : i + 1], a = 3 * v, b = 3 * w;
    const length = Math.hypot(position[b] - position[a], position[b + 1] - position[a + 1], position[b + 2] - position[a + 2]);
    for (const end of [v, w]) { sum[end] += length; edges[end]++; }
  }
  return sum.map((length, v) => length / (edges[v] || 1) * size / 65535);
}

/** Number of elements that are at least `least`, in a descending array. */
function countAtLeast(numbers, least) {
  let [low, high] = [0, numbers.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] >= least) low = middle + 1; else high = middle;
  }
  return low;
}

function attribute(gl, at, values, size, kind, normalized) {
  const made = buffer(gl, values);
  gl.enableVertexAttribArray(at);
  gl.vertexAttribPointer(at, size, kind, normalized, 0, 0);
  return made;
}

function integerAttribute(gl, at, values) {
  buffer(gl, values);
  gl.enableVertexAttribArray(at);
  gl.vertexAttribIPointer(at, 1, gl.UNSIGNED_INT, 0, 0);
}

function bounds(position, origin, step) {
  const low = [65535, 65535, 65535], high = [0, 0, 0];
  for (let i = 0; i < position.length; i++) {
    const k = i % 3;
    if (position[i] < low[k]) low[k] = position[i];
    if (position[i] > high[k]) high[k] = position[i];
  }
  const centre = [0, 1, 2].map(k => origin[k] + step * (low[k] + high[k]) / 2);
  return { centre, radius: step * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) / 2,
    low: low.map((x, k) => origin[k] + step * x), high: high.map((x, k) => origin[k] + step * x) };
}

/** Vertex normals: area-weighted means of the adjacent face normals. */
function vertexNormals(position, corners) {
  const sum = new Float32Array(position.length);
  for (let i = 0; i < corners.length; i += 3) {
    const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
    const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1], uz = position[b + 2] - position[a + 2];
    const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1], vz = position[c + 2] - position[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const p of [a, b, c]) { sum[p] += nx; sum[p + 1] += ny; sum[p + 2] += nz; }
  }
  const out = new Int8Array(4 * position.length / 3);
  for (let i = 0, o = 0; i < sum.length; i += 3, o += 4) {
    const l = 127 / (Math.sqrt(sum[i] ** 2 + sum[i + 1] ** 2 + sum[i + 2] ** 2) || 1);
    out[o] = sum[i] * l; out[o + 1] = sum[i + 1] * l; out[o + 2] = sum[i + 2] * l;
  }
  return out;
}

/** Largest code of the value of an edge, minus 1. */
const VALUE_STEPS = 1 << 20;

/** Network arrays, for drawing and for queries. */
class Network {
  constructor(array) {
    const { grid, radiusStep } = facts.network;
    this.nodes = Float64Array.from(array("node"), (x, i) => grid.origin[i % 3] + grid.step * x);
    this.names = array("nodeName");
    this.edges = array("edge");
    this.radii = Float64Array.from(array("edgeRadius"), r => r * radiusStep);
    this.orders = array("edgeOrder");
    this.branches = array("edgeBranch");
    this.values = array("edgeValue");
  }

  /** Code of the value of an edge at a parameter; 0 without a value. */
  valueCode(edge, t) {
    const [a, b] = [this.values[2 * edge], this.values[2 * edge + 1]];
    return a === 0 || b === 0 ? 0 : a + t * (b - a);
  }

  /** Value of the array at a point of an edge, with name and unit. */
  value(edge, t) {
    const { name, unit, scale: { low, high, logarithmic } } = facts.data;
    const code = this.valueCode(edge, t), share = (code - 1) / VALUE_STEPS;
    const value = logarithmic ? low * (high / low) ** share : low + share * (high - low);
    return `\n${name} ${code === 0 ? "unknown" : `${number(value, 4)}${unit ? ` ${unit}` : ""}`}`;
  }

  node(i) { return [this.nodes[3 * i], this.nodes[3 * i + 1], this.nodes[3 * i + 2]]; }

  /** Edge whose wall is nearest to a position, with the edge parameter and radius there. */
  nearest(place) {
    let best = { least: Infinity };
    for (let e = 0; e < this.orders.length; e++) {
      const a = 3 * this.edges[2 * e], b = 3 * this.edges[2 * e + 1];
      const dx = this.nodes[b] - this.nodes[a], dy = this.nodes[b + 1] - this.nodes[a + 1], dz = this.nodes[b + 2] - this.nodes[a + 2];
      const px = place[0] - this.nodes[a], py = place[1] - this.nodes[a + 1], pz = place[2] - this.nodes[a + 2];
      const t = Math.min(Math.max((px * dx + py * dy + pz * dz) / (dx * dx + dy * dy + dz * dz || 1), 0), 1);
      const radius = this.radii[2 * e] + t * (this.radii[2 * e + 1] - this.radii[2 * e]);
      const least = Math.hypot(px - t * dx, py - t * dy, pz - t * dz) - radius;
      if (least < best.least) best = { least, edge: e, t, radius };
    }
    return best;
  }

  /** Description of a point on an edge: branch, order, nodes, radius. */
  describe({ edge, t, radius }) {
    const ends = [0, 1].map(k => this.names[this.edges[2 * edge + k]]);
    return `vessel (branch) ${this.branches[edge]}, order ${this.orders[edge]}\nedge ${ends[0]}–${ends[1]}, nearest node ` +
      `${ends[t > 0.5 ? 1 : 0]}\nradius ${withUnit(number(radius))}${facts.data ? this.value(edge, t) : ""}`;
  }
}

/** Cones of a network, widest first. */
class Cones {
  constructor(gl, network) {
    this.gl = gl;
    this.network = network;
    const count = network.orders.length;
    this.order = Uint32Array.from({ length: count }, (_, i) => i);
    const wide = e => Math.max(network.radii[2 * e], network.radii[2 * e + 1]);
    this.order.sort((a, b) => wide(b) - wide(a) || a - b);
    this.radii = Float64Array.from(this.order, wide);
    const ends = new Float32Array(8 * count), names = new Uint32Array(count);
    this.order.forEach((e, i) => {
      for (const k of [0, 1]) {
        ends.set(network.node(network.edges[2 * e + k]), 8 * i + 4 * k);
        ends[8 * i + 4 * k + 3] = network.radii[2 * e + k];
      }
      names[i] = e + 1;
    });
    this.names = names;
    // Three levels of detail by sides and rings; thin cones have no end caps.
    this.levels = [[20, [-0.5, 0, 1, 1.5]], [8, [-0.5, 0, 1, 1.5]], [4, [0, 1]]]
      .map(([sides, rings]) => this.level(sides, rings, ends, names));
    this.lines = gl.createVertexArray();
    gl.bindVertexArray(this.lines);
    buffer(gl, ends);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 16, 0);
    this.lineColours = attribute(gl, 2, new Uint8Array(8 * count), 4, gl.UNSIGNED_BYTE, true);
    integerAttribute(gl, 3, Uint32Array.from({ length: 2 * count }, (_, i) => names[i >> 1]));
    gl.bindVertexArray(null);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < ends.length; i += 4) for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], ends[i + k] - ends[i + 3]);
      high[k] = Math.max(high[k], ends[i + k] + ends[i + 3]);
    }
    this.chunks = [{ box: { low, high, centre: add(low, high).map(x => x / 2), radius: Math.hypot(...add(high, low, -1)) / 2 } }];
  }

  level(sides, rings, ends, names) {
    const gl = this.gl, corners = [], faces = [];
    rings.forEach((z, ring) => {
      for (let i = 0; i < sides; i++) corners.push(Math.cos(2 * Math.PI * i / sides), Math.sin(2 * Math.PI * i / sides), z);
      if (ring === rings.length - 1) return;
      for (let i = 0; i < sides; i++) {
        const a = ring * sides + i, b = ring * sides + (i + 1) % sides;
        faces.push(a, b, b + sides, a, b + sides, a + sides);
      }
    });
    const made = gl.createVertexArray();
    gl.bindVertexArray(made);
    attribute(gl, 0, Float32Array.from(corners), 3, gl.FLOAT, false);
    const level = { made, count: faces.length };
    level.ends = buffer(gl, ends);
    level.colours = buffer(gl, new Uint8Array(4 * names.length));
    level.names = buffer(gl, names);
    buffer(gl, Uint16Array.from(faces), gl.ELEMENT_ARRAY_BUFFER);
    for (const at of [1, 2, 3, 4]) { gl.enableVertexAttribArray(at); gl.vertexAttribDivisor(at, 1); }
    return level;
  }

  /** Binds the instance buffers of a level, starting at instance `first`. */
  from(level, first) {
    const gl = this.gl;
    gl.bindVertexArray(level.made);
    gl.bindBuffer(gl.ARRAY_BUFFER, level.ends);
    gl.vertexAttribPointer(1, 4, gl.FLOAT, false, 32, 32 * first);
    gl.vertexAttribPointer(2, 4, gl.FLOAT, false, 32, 32 * first + 16);
    gl.bindBuffer(gl.ARRAY_BUFFER, level.colours);
    gl.vertexAttribPointer(3, 4, gl.UNSIGNED_BYTE, true, 0, 4 * first);
    gl.bindBuffer(gl.ARRAY_BUFFER, level.names);
    gl.vertexAttribIPointer(4, 1, gl.UNSIGNED_INT, 0, 4 * first);
  }

  colour(what) {
    const gl = this.gl, { network } = this, [low, high] = facts.network.radii, most = facts.network.orders;
    const out = new Uint8Array(4 * this.order.length), twice = new Uint8Array(8 * this.order.length);
    this.order.forEach((e, i) => {
      const radius = (network.radii[2 * e] + network.radii[2 * e + 1]) / 2;
      const colour = what === "radius" ? viridis(high > low ? Math.log(radius / low) / Math.log(high / low) : 0.5)
        : what === "order" ? viridis(most > 1 ? (network.orders[e] - 1) / (most - 1) : 0.5)
        : what === "value" ? valueColour(network.valueCode(e, 0.5), VALUE_STEPS + 1)
        : what === "block" ? blockColour(network.branches[e]) : PALETTE.wall;
      out.set(colour, 4 * i);
      out[4 * i + 3] = 255;
    });
    for (let i = 0; i < this.order.length; i++) for (const k of [0, 4]) twice.set(out.subarray(4 * i, 4 * i + 4), 8 * i + k);
    for (const [target, values] of [...this.levels.map(l => [l.colours, out]), [this.lineColours, twice]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, target);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    }
  }

  /** Draws cones by decreasing number of sides, and the thinnest as lines. */
  draw(programs, set, view) {
    const gl = this.gl;
    const [near, middle, far] = [6, 2.5, 0.8].map(pixels => countAtLeast(this.radii, pixels * view.coarsening / view.scale));
    set(programs.cones);
    gl.uniform1f(programs.cones.at.thinnest, 0);
    [[0, near], [near, middle], [middle, far]].forEach(([from, to], i) => {
      const level = this.levels[i];
      if (to <= from) return;
      this.from(level, from);
      gl.drawElementsInstanced(gl.TRIANGLES, level.count, gl.UNSIGNED_SHORT, 0, to - from);
    });
    if (far < this.radii.length) {
      const { at } = set(programs.faces);
      gl.uniform3f(at.origin, 0, 0, 0);
      gl.uniform1f(at.size, 1);
      gl.uniform1f(at.flatness, 2);
      gl.bindVertexArray(this.lines);
      // During motion the thinnest lines are omitted.
      gl.drawArrays(gl.LINES, 2 * far, 2 * Math.ceil((this.radii.length - far) / Math.max(view.coarsening / 4, 1)));
    }
  }
}

/** Formats a number with up to this number of significant digits. */
function number(x, digits = 5) {
  return Math.abs(x) >= 1e6 || (x !== 0 && Math.abs(x) < 1e-3) ? x.toExponential(Math.min(digits, 4) - 1) : String(Number(x.toPrecision(digits)));
}
