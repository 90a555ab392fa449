// Page: camera, controls, queries.

const $ = id => document.getElementById(id);

/** Camera with parallel projection. */
class View {
  constructor(box) {
    this.box = box;
    // Looks along the shortest side of the box, with the longest side horizontal.
    const side = add(box.high, box.low, -1), order = [0, 1, 2].sort((a, b) => side[a] - side[b]);
    const axis = k => [0, 1, 2].map(i => Number(i === k));
    this.towards = axis(order[0]);
    this.up = axis(order[1]);
    if (order[0] === 1) this.towards = [0, -1, 0];
    this.right = cross(this.up, this.towards);
    this.centre = box.centre;
    this.zoom = 1;
    // Coarsening factor during motion; 1 is full detail.
    this.haste = 1;
  }

  /** Pixels per unit of length. */
  get scale() {
    const { width, height } = $("canvas"), side = add(this.box.high, this.box.low, -1);
    const extent = axis => Math.abs(axis[0] * side[0]) + Math.abs(axis[1] * side[1]) + Math.abs(axis[2] * side[2]);
    const first = this.first ||= [extent(this.right), extent(this.up)];
    return 0.92 * this.zoom * Math.min(width / (first[0] || 1), height / (first[1] || 1));
  }

  get matrix() {
    const { width, height } = $("canvas"), s = this.scale, reach = 1.05 * this.box.radius + Math.hypot(...add(this.centre, this.box.centre, -1));
    const rows = [this.right.map(x => 2 * s * x / width), this.up.map(x => 2 * s * x / height), this.towards.map(x => -x / reach)];
    const shift = rows.map(row => -dot(row, this.centre));
    return new Float32Array([...[0, 1, 2].flatMap(k => [rows[0][k], rows[1][k], rows[2][k], 0]), ...shift, 1]);
  }

  get turn() { return new Float32Array([0, 1, 2].flatMap(k => [this.right[k], this.up[k], this.towards[k]])); }

  sees(box) {
    const v = add(box.centre, this.centre, -1), r = box.radius, s = this.scale;
    return Math.abs(dot(v, this.right)) - r < $("canvas").width / 2 / s && Math.abs(dot(v, this.up)) - r < $("canvas").height / 2 / s;
  }

  turnBy(dx, dy) {
    const spin = (v, axis, angle) => {
      const [c, s] = [Math.cos(angle), Math.sin(angle)], w = cross(axis, v), along = dot(axis, v) * (1 - c);
      return [0, 1, 2].map(k => v[k] * c + w[k] * s + axis[k] * along);
    };
    this.towards = unit(spin(spin(this.towards, this.up, -dx), this.right, -dy));
    this.up = unit(spin(this.up, this.right, -dy));
    this.right = unit(cross(this.up, this.towards));
    this.up = cross(this.towards, this.right);
  }

  moveBy(dx, dy) {
    this.centre = add(add(this.centre, this.right, -dx / this.scale), this.up, dy / this.scale);
  }

  /** Position of a pixel relative to the centre, at a depth between 0 and 1. */
  place(dx, dy, depth) {
    const reach = 1.05 * this.box.radius + Math.hypot(...add(this.centre, this.box.centre, -1));
    const across = add(add(this.centre, this.right, dx / this.scale), this.up, -dy / this.scale);
    return add(across, this.towards, (1 - 2 * depth) * reach);
  }
}

class Viewer {
  constructor(array) {
    const canvas = $("canvas");
    const gl = this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: false });
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.programs = { faces: program(gl, FACES), cones: program(gl, CONES) };
    this.frame = nameTarget(gl);
    this.network = facts.network ? new Network(array) : null;
    this.wall = facts.wall ? new Walls(gl, array) : null;
    this.tets = facts.tets && facts.tets.shown > 0 ? new Tets(gl, array) : null;
    this.cones = this.wall ? null : new Cones(gl, this.network);
    const chunks = (this.wall || this.cones).chunks;
    const low = [0, 1, 2].map(k => Math.min(...chunks.map(c => c.box.low[k])));
    const high = [0, 1, 2].map(k => Math.max(...chunks.map(c => c.box.high[k])));
    const box = { low, high, centre: add(low, high).map(x => x / 2), radius: Math.hypot(...add(high, low, -1)) / 2 || 1 };
    this.view = new View(box);
    this.plane = [0, 0, 0, 1];
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    // Default name 0 for geometry without names; the attribute must be an integer.
    gl.vertexAttribI4ui(3, 0, 0, 0, 0);
    // Large walls start coarse during motion, and get finer if the frame time permits.
    this.haste = Math.min(Math.max((this.wall ? this.wall.triangles : 0) / 60000, 1), 64);
    this.fill();
    this.listen();
    this.colour();
  }

  /** Requests a coarse frame, and a full one 200 ms after the last motion. */
  move() {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => { this.moving = false; this.redraw(); }, 200);
    this.redraw();
  }

  /** Requests a frame. */
  redraw() {
    this.pending ||= requestAnimationFrame(() => { this.pending = 0; this.draw(); });
  }

  draw() {
    const { gl } = this, canvas = $("canvas"), ratio = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio].map(Math.round);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const ground = getComputedStyle(document.documentElement).getPropertyValue("--paper").trim();
    this.ground = [1, 3, 5].map(i => parseInt(ground.slice(i, i + 2), 16) / 255);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...this.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const start = performance.now();
    this.view.haste = this.moving ? this.haste : 1;
    this.scene(0, this.view.matrix);
    if (!this.moving) return;
    // Reading a pixel waits for the frame, so that its time can be measured.
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    const took = performance.now() - start;
    this.haste = Math.min(Math.max(this.haste * (took > 40 ? 1.6 : took < 15 ? 0.85 : 1), 1), 64);
  }

  /** Draws the scene with colours, or with names for picking. */
  scene(names, camera) {
    const { gl, view } = this;
    const set = one => {
      gl.useProgram(one.made);
      gl.uniformMatrix4fv(one.at.camera, false, camera);
      gl.uniformMatrix3fv(one.at.turn, false, view.turn);
      gl.uniform4fv(one.at.cut, this.plane);
      gl.uniform1i(one.at.names, names);
      gl.uniform3fv(one.at.ground, this.ground);
      gl.uniform1f(one.at.fade, 0.45);
      gl.uniform1f(one.at.reach, 1);
      gl.uniform1f(one.at.flatness, 0);
      return one;
    };
    if (this.cones) return this.cones.draw(this.programs, set, view);
    const { at } = set(this.programs.faces);
    const lined = !names && $("edges").checked;
    if (lined) { gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(1, 1); }
    this.wall.draw(at, view, lined);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (this.tets && this.plane[3] !== 1) this.tets.draw(at);
  }

  /** Returns the group or edge at a pixel and the position; `null` for the background. */
  pick(x, y) {
    const { gl } = this, canvas = $("canvas"), ratio = canvas.width / canvas.clientWidth;
    const [px, py] = [x * ratio, y * ratio];
    // Scales and shifts the camera so that this pixel fills the frame.
    const camera = this.view.matrix, [w, h] = [canvas.width, canvas.height];
    for (let k = 0; k < 4; k++) {
      const own = camera[4 * k + 3];
      camera[4 * k] = w * camera[4 * k] + (w - 2 * px) * own;
      camera[4 * k + 1] = h * camera[4 * k + 1] - (h - 2 * py) * own;
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.viewport(0, 0, 1, 1);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.COLOR, 1, [0, 0, 0, 0]);
    gl.clearBufferfi(gl.DEPTH_STENCIL, 0, 1, 0);
    this.scene(1, camera);
    const read = attachment => {
      const bytes = new Uint8Array(4);
      gl.readBuffer(attachment);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      return bytes;
    };
    const [name, far] = [read(gl.COLOR_ATTACHMENT0), read(gl.COLOR_ATTACHMENT1)];
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    if (far[3] === 0) return null;
    const id = name[0] + 256 * name[1] + 65536 * name[2] + 16777216 * name[3];
    const depth = (far[0] + 256 * far[1] + 65536 * far[2]) / 16777215;
    return { id, place: this.view.place(px - w / 2, py - h / 2, depth) };
  }

  /** Describes the result of `pick`. */
  told(found) {
    const lines = [];
    if (this.wall && found.id > 0) {
      const patch = this.wall.groups.patch[found.id - 1], known = patches.get(patch);
      lines.push(`patch ${patch}${known ? `: ${known.name}` : ""}${known && known.node != null ? ` (node ${known.node})` : ""}`);
      lines.push(`block ${this.wall.groups.block[found.id - 1]}`);
    } else if (this.wall) lines.push("inside of the mesh");
    if (this.network) {
      const edge = this.wall ? this.network.nearest(found.place) : this.along(found.id - 1, found.place);
      lines.push(this.network.told(edge));
    }
    lines.push(`at ${found.place.map(number).join(" ")}`);
    return lines.join("\n");
  }

  /** Edge parameter of the point nearest to a position, with the radius there. */
  along(edge, place) {
    const { network } = this, [a, b] = [0, 1].map(k => network.node(network.edges[2 * edge + k]));
    const d = add(b, a, -1), t = Math.min(Math.max(dot(add(place, a, -1), d) / (dot(d, d) || 1), 0), 1);
    return { edge, t, radius: network.radii[2 * edge] + t * (network.radii[2 * edge + 1] - network.radii[2 * edge]) };
  }

  /** Centres the view on a fault and describes it. */
  fly(fault, item) {
    document.querySelectorAll("li.at").forEach(li => li.classList.remove("at"));
    item?.classList.add("at");
    this.view.centre = fault.place;
    this.view.zoom = 1;
    const extent = fault.extent > 0 ? fault.extent : 0.02 * this.view.box.radius;
    this.view.zoom = Math.max($("canvas").height / (4 * extent) / this.view.scale, 1);
    $("ring").hidden = false;
    $("pick").hidden = false;
    $("pick").textContent = `${fault.what}\nat ${fault.place.map(number).join(" ")}`;
    this.redraw();
  }

  /** Centres the view on `#at=x,y,z` of the address, and describes the object there. */
  goWhereTheAddressSays() {
    const place = (location.hash.match(/^#at=([-+.,\deE]+)$/) || ["", ""])[1].split(",").map(Number);
    if (place.length !== 3 || !place.every(Number.isFinite)) return;
    this.fly({ what: "", place, extent: 0 });
    this.draw();
    const { clientWidth, clientHeight } = $("canvas");
    this.ask(clientWidth / 2, clientHeight / 2);
  }

  cut() {
    const axis = $("axis").value, { view } = this;
    $("place").disabled = axis === "";
    if (axis === "") this.plane = [0, 0, 0, 1];
    else {
      // Removes the side that faced the viewer when the axis was selected.
      const normal = axis === "view" ? view.towards : ["x", "y", "z"].map(a => this.side * Number(a === axis));
      const half = [0, 1, 2].reduce((sum, k) => sum + Math.abs(normal[k]) * (view.box.high[k] - view.box.low[k]) / 2, 0);
      const place = ($("place").value / 500 - 1) * (axis === "view" ? 1 : this.side);
      this.plane = [...normal, dot(normal, view.box.centre) + half * place];
    }
    if (this.tets && axis !== "") this.tets.cut(this.plane, (block, corners) => {
      const what = $("colour").value;
      return what === "quality" ? between(QUALITY, radiusRatio(corners)) : what === "block" ? ofBlock(block) : PALETTE.inside;
    });
    this.redraw();
  }

  colour() {
    const what = $("colour").value;
    (this.wall || this.cones).colour(what);
    const legend = $("legend");
    const scale = (colours, low, high) => {
      const bar = document.createElement("div"), ends = document.createElement("div");
      bar.className = "scale";
      bar.style.background = `linear-gradient(to right, ${colours.map(c => `rgb(${c})`).join(",")})`;
      ends.className = "ends";
      for (const text of [low, high]) ends.append(Object.assign(document.createElement("span"), { textContent: text }));
      legend.replaceChildren(bar, ends);
    };
    const shades = Array.from({ length: 9 }, (_, i) => viridis(i / 8));
    const radii = facts.wall ? facts.wall.radii : facts.network.radii;
    if (what === "radius") scale(shades, number(radii[0]), number(radii[1]));
    else if (what === "order") scale(shades, "1", String(facts.network.orders));
    else if (what === "quality") scale(QUALITY, "radius ratio 0", "1");
    else if (what === "patch") legend.replaceChildren(...["wall", "inlet", "outlet", "inside"].map(name => {
      const item = document.createElement("span"), box = document.createElement("i");
      box.style.background = `rgb(${PALETTE[name]})`;
      item.append(box, name);
      return item;
    }));
    else legend.replaceChildren();
    this.cut();
  }

  /** Fills the panel. */
  fill() {
    $("title").textContent = document.title = facts.title;
    const of = (n, what) => `${n.toLocaleString("en")} ${what}`;
    const shown = this.wall && !facts.wall.exact ? `, ${of(this.wall.triangles, "shown")}` : "";
    $("counts").textContent = this.wall
      ? (facts.tets && facts.tets.all ? of(facts.tets.all, "tetrahedra, ") : "") + of(facts.wall.faces, "faces") + shown
      : of(facts.network.edges, "edges");
    const colours = this.wall ? ["patch", "block", "quality", ...(facts.wall.radii ? ["radius", "order"] : [])] : ["radius", "order", "block"];
    $("colour").append(...colours.map(name => Object.assign(document.createElement("option"), { textContent: name })));
    $("edges").checked = !!this.wall && facts.wall.exact && this.wall.triangles < 60000;
    $("edges").parentElement.hidden = !this.wall;
    if (this.tets && facts.tets.shown < facts.tets.all) {
      const [axis, at] = facts.tets.plane;
      $("held").textContent = `Tetrahedra: ${of(facts.tets.shown, "in blocks")} across ${"xyz"[axis]} = ${number(at)}; elsewhere the wall is hollow.`;
    }
    const faults = facts.faults || [];
    $("faults").hidden = faults.length === 0;
    document.querySelector("#faults h2").textContent = of(faults.length, faults.length === 1 ? "fault" : "faults");
    document.querySelector("#faults ol").append(...faults.map(fault => {
      const item = document.createElement("li");
      item.textContent = fault.what;
      item.onclick = () => this.fly(fault, item);
      return item;
    }));
  }

  listen() {
    const canvas = $("canvas"), { view } = this;
    let last = null, moved = 0;
    canvas.onpointerdown = e => { canvas.setPointerCapture(e.pointerId); last = e; moved = 0; };
    canvas.onpointermove = e => {
      if (!last) return;
      const [dx, dy] = [e.clientX - last.clientX, e.clientY - last.clientY], ratio = canvas.width / canvas.clientWidth;
      moved += Math.abs(dx) + Math.abs(dy);
      if (e.shiftKey || e.buttons & 2) view.moveBy(dx * ratio, dy * ratio); else view.turnBy(dx / 200, dy / 200);
      last = e;
      $("ring").hidden = true;
      if ($("axis").value === "view") this.cut();
      this.move();
    };
    canvas.onpointerup = e => {
      if (last && moved < 4 && e.button === 0) this.ask(e.offsetX, e.offsetY);
      last = null;
    };
    canvas.oncontextmenu = e => e.preventDefault();
    canvas.ondblclick = e => {
      const found = this.pick(e.offsetX, e.offsetY);
      if (found) { view.centre = found.place; this.redraw(); }
    };
    canvas.addEventListener("wheel", e => {
      e.preventDefault();
      const ratio = canvas.width / canvas.clientWidth;
      const [dx, dy] = [e.offsetX * ratio - canvas.width / 2, e.offsetY * ratio - canvas.height / 2];
      // Zooms about the pointer.
      view.moveBy(-dx, -dy);
      view.zoom = Math.min(Math.max(view.zoom * Math.exp(-e.deltaY / 600), 0.2), 1e5);
      view.moveBy(dx, dy);
      $("ring").hidden = true;
      this.move();
    }, { passive: false });
    canvas.onkeydown = e => {
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
      if (turns[e.key]) view.turnBy(...turns[e.key]);
      else if (e.key === "+" || e.key === "-") view.zoom *= e.key === "+" ? 1.25 : 0.8;
      else return;
      this.move();
    };
    $("colour").onchange = () => this.colour();
    $("axis").onchange = () => {
      this.side = view.towards["xyz".indexOf($("axis").value)] < 0 ? -1 : 1;
      // Starts at the plane whose tetrahedra the page contains.
      const held = facts.tets && facts.tets.shown < facts.tets.all && facts.tets.plane;
      if (held && $("axis").value === "xyz"[held[0]]) {
        const [k, at] = held, { low, high } = view.box;
        $("place").value = 1000 * (at - low[k]) / (high[k] - low[k]);
      }
      this.cut();
    };
    $("place").oninput = () => this.cut();
    $("edges").onchange = () => this.redraw();
    $("all").onclick = () => {
      Object.assign(view, new View(view.box), { first: view.first });
      $("ring").hidden = $("pick").hidden = true;
      this.cut();
    };
    $("dark").onclick = () => {
      const root = document.documentElement.classList, dark = matchMedia("(prefers-color-scheme: dark)").matches;
      const isDark = root.contains("dark") || (dark && !root.contains("light"));
      root.toggle("dark", !isDark);
      root.toggle("light", isDark);
      this.redraw();
    };
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }

  /** Describes the object at a pixel. */
  ask(x, y) {
    const found = this.pick(x, y);
    $("ring").hidden = true;
    $("pick").hidden = !found;
    if (found) $("pick").textContent = this.told(found);
    this.redraw();
    return found && $("pick").textContent;
  }
}

let viewer = null;
unpacked().then(bytes => {
  viewer = new Viewer(arrays(bytes));
  viewer.draw();
  viewer.goWhereTheAddressSays();
  $("wait").remove();
  document.documentElement.dataset.ready = Math.round(performance.now());
}).catch(error => {
  $("wait").textContent = `The page cannot be shown: ${error.message}`;
  console.error(error);
});
