// Viewer: scene, picking, clip plane.

class Viewer {
  constructor(array) {
    collapsePanel(matchMedia("(max-width: 40rem)").matches);
    const canvas = $("canvas");
    const gl = this.gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: false });
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
    this.coarsening = Math.min(Math.max((this.wall ? this.wall.triangles : 0) / 60000, 1), 64);
    fillPanel(this);
    listenToPanel(this);
    listenToPointers(this);
    listenToKeys(this);
    this.colour();
  }

  /** Requests a simplified frame after a motion, and a full one 200 ms after the last. */
  moved() {
    $("ring").hidden = true;
    if ($("axis").value === "view") this.clip();
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
    this.view.coarsening = this.moving ? this.coarsening : 1;
    drawOverlays(this.view, this.view.scale / ratio);
    this.scene(0, this.view.matrix);
    if (!this.moving) return;
    // Reading a pixel waits for the frame, so that its time can be measured.
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    const took = performance.now() - start;
    this.coarsening = Math.min(Math.max(this.coarsening * (took > 40 ? 1.6 : took < 15 ? 0.85 : 1), 1), 64);
  }

  /** Draws the scene with colours, or with names for picking. */
  scene(names, camera) {
    const { gl, view } = this;
    const set = one => {
      gl.useProgram(one.made);
      gl.uniformMatrix4fv(one.at.camera, false, camera);
      gl.uniformMatrix3fv(one.at.turn, false, view.rotation);
      gl.uniform4fv(one.at.cut, this.plane);
      gl.uniform1i(one.at.names, names);
      gl.uniform3fv(one.at.ground, this.ground);
      gl.uniform1f(one.at.fade, 0.45);
      gl.uniform1f(one.at.reach, 1);
      gl.uniform1f(one.at.flatness, 0);
      gl.uniform1f(one.at.pixels, 0);
      return one;
    };
    if (this.cones) return this.cones.draw(this.programs, set, view);
    const { at } = set(this.programs.faces);
    const lined = !names && $("edges").checked;
    if (lined) { gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(1, 1); }
    this.wall.draw(at, view, lined);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (this.tets && this.plane[3] !== 1) this.tets.draw(at, view);
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
    return { id, position: this.view.position(px - w / 2, py - h / 2, depth) };
  }

  /** Describes the result of `pick`. */
  describe(found) {
    const lines = [];
    if (this.wall && found.id > 0) {
      const patch = this.wall.groups.patch[found.id - 1], known = patches.get(patch);
      lines.push(`patch ${patch}${known ? `: ${known.name}` : ""}${known && known.node != null ? ` (node ${known.node})` : ""}`);
      const block = this.wall.groups.block[found.id - 1];
      lines.push(regions.has(block) ? `region ${block}: ${regions.get(block).name}` : `block ${block}`);
    } else if (this.wall) lines.push("clipped tetrahedron");
    if (this.network) {
      const edge = this.wall ? this.network.nearest(found.position) : this.along(found.id - 1, found.position);
      lines.push(this.network.describe(edge));
    }
    lines.push(`at ${withUnit(found.position.map(x => number(x)).join(" "))}`);
    return lines.join("\n");
  }

  /** Edge parameter of the point nearest to a position, with the radius there. */
  along(edge, place) {
    const { network } = this, [a, b] = [0, 1].map(k => network.node(network.edges[2 * edge + k]));
    const d = add(b, a, -1), t = Math.min(Math.max(dot(add(place, a, -1), d) / (dot(d, d) || 1), 0), 1);
    return { edge, t, radius: network.radii[2 * edge] + t * (network.radii[2 * edge + 1] - network.radii[2 * edge]) };
  }

  /** Centres the view on a fault and describes it. */
  flyTo(fault, button, group) {
    document.querySelector("#faults [aria-current]")?.removeAttribute("aria-current");
    button?.setAttribute("aria-current", "true");
    const { view } = this;
    view.centre = fault.place;
    view.zoom = 1;
    const extent = fault.extent > 0 ? fault.extent : 0.02 * view.box.radius;
    view.zoom = Math.max($("canvas").height / (4 * extent) / view.scale, 1);
    $("ring").hidden = $("pick").hidden = false;
    $("pick").textContent = [group?.kind, fault.what, `at ${withUnit(fault.place.map(x => number(x)).join(" "))}`].filter(Boolean).join("\n");
    this.redraw();
  }

  /** Shows the position `#at=x,y,z` of the address and the object there, or the fault `#fault=n`. */
  openFromHash() {
    const fault = location.hash.match(/^#fault=(\d+)$/);
    if (fault) document.querySelectorAll("#faults li button")[fault[1] - 1]?.click();
    const place = (location.hash.match(/^#at=([-+.,\deE]+)$/) || ["", ""])[1].split(",").map(Number);
    if (place.length !== 3 || !place.every(Number.isFinite)) return;
    this.flyTo({ what: "", place, extent: 0 });
    this.draw();
    const { clientWidth, clientHeight } = $("canvas");
    this.showPick(clientWidth / 2, clientHeight / 2);
  }

  /** Shows the whole object from its first direction. */
  reset() {
    this.view.reset();
    $("ring").hidden = $("pick").hidden = true;
    this.clip();
  }

  /** Starts to clip along an axis, on the side that faces the viewer. */
  chooseClipAxis() {
    const { view } = this, axis = $("axis").value;
    this.side = view.towards["xyz".indexOf(axis)] < 0 ? -1 : 1;
    // Starts at the plane whose tetrahedra the page contains, otherwise in the middle of the view, as at a fault.
    const held = facts.tets && facts.tets.shown < facts.tets.all && axis === "xyz"[facts.tets.plane[0]];
    const normal = axis === "view" ? view.towards : ["x", "y", "z"].map(a => Number(a === axis));
    const offset = held ? facts.tets.plane[1] - dot(normal, view.box.centre) : dot(normal, add(view.centre, view.box.centre, -1));
    const half = this.halfDepth(normal);
    $("place").value = 500 * (1 + offset / (half || 1));
    this.clip();
  }

  /** Half the extent of the box along a direction. */
  halfDepth(normal) {
    const { low, high } = this.view.box;
    return [0, 1, 2].reduce((sum, k) => sum + Math.abs(normal[k]) * (high[k] - low[k]) / 2, 0);
  }

  /** Applies the clip plane. */
  clip() {
    const axis = $("axis").value, { view } = this;
    $("place").disabled = axis === "";
    if (axis === "") this.plane = [0, 0, 0, 1];
    else {
      // Removes the side that faced the viewer when the axis was selected.
      const normal = axis === "view" ? view.towards : ["x", "y", "z"].map(a => this.side * Number(a === axis));
      const half = this.halfDepth(normal);
      const place = ($("place").value / 500 - 1) * (axis === "view" ? 1 : this.side);
      this.plane = [...normal, dot(normal, view.box.centre) + half * place];
    }
    if (this.tets && axis !== "") this.tets.cut(this.plane, (block, corners) => {
      const quantity = $("colour").value;
      return quantity === "quality" ? interpolate(QUALITY, radiusRatio(corners)) : quantity === "block" ? blockColour(block)
        : regions.size > 0 ? regionColour(block) : PALETTE.inside;
    });
    this.redraw();
  }

  /** Shows or hides a region. */
  toggle(id, isOn) {
    regions.get(id).hidden = !isOn;
    this.wall.show();
    this.clip();
  }

  /** Applies the selected colours. */
  colour() {
    const quantity = $("colour").value, scene = this.wall || this.cones;
    scene.colour(quantity);
    $("legend").replaceChildren(...legendOf(quantity, scene));
    this.clip();
  }

  /** Describes the object at a pixel. */
  showPick(x, y) {
    const found = this.pick(x, y);
    $("ring").hidden = true;
    $("pick").hidden = !found;
    if (found) $("pick").textContent = this.describe(found);
    this.redraw();
  }
}

let viewer = null;
unpack().then(bytes => {
  viewer = new Viewer(decoder(bytes));
  viewer.draw();
  viewer.openFromHash();
  $("loading").remove();
  document.documentElement.dataset.ready = Math.round(performance.now());
}).catch(error => {
  $("loading").textContent = `The page cannot be shown: ${error.message}`;
  console.error(error);
});
