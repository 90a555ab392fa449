// Mouse, touch and keyboard.

/** Handles pointers on the canvas: one rotates or pans, two pan and zoom. */
function listenToPointers(viewer) {
  const canvas = $("canvas"), { view } = viewer, pointers = new Map();
  let moved = 0, several = false;
  const ratio = () => canvas.width / canvas.clientWidth;
  /** Middle and spread of the pointers, in pixels relative to the middle of the canvas. */
  const pinch = () => {
    const [a, b] = [...pointers.values()];
    const middle = [(a.offsetX + b.offsetX) / 2 * ratio() - canvas.width / 2, (a.offsetY + b.offsetY) / 2 * ratio() - canvas.height / 2];
    return { middle, spread: Math.hypot(a.offsetX - b.offsetX, a.offsetY - b.offsetY) || 1 };
  };
  canvas.onpointerdown = e => {
    canvas.setPointerCapture(e.pointerId);
    if (pointers.size === 0) [moved, several] = [0, false];
    pointers.set(e.pointerId, e);
    several ||= pointers.size > 1;
  };
  canvas.onpointermove = e => {
    const last = pointers.get(e.pointerId);
    if (!last) return;
    const [dx, dy] = [e.clientX - last.clientX, e.clientY - last.clientY];
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 2) {
      const before = pinch();
      pointers.set(e.pointerId, e);
      const { middle, spread } = pinch();
      view.pan(middle[0] - before.middle[0], middle[1] - before.middle[1]);
      view.zoomBy(spread / before.spread, ...middle);
    } else {
      pointers.set(e.pointerId, e);
      if (e.shiftKey || e.buttons & 2) view.pan(dx * ratio(), dy * ratio()); else view.rotate(dx / 200, dy / 200);
    }
    viewer.moved();
  };
  canvas.onpointerup = e => {
    const isTap = pointers.delete(e.pointerId) && !several && moved < (e.pointerType === "touch" ? 10 : 4);
    if (isTap && e.button === 0) viewer.showPick(e.offsetX, e.offsetY);
  };
  canvas.onpointercancel = e => pointers.delete(e.pointerId);
  canvas.oncontextmenu = e => e.preventDefault();
  canvas.ondblclick = e => {
    const found = viewer.pick(e.offsetX, e.offsetY);
    if (found) { view.centre = found.position; viewer.redraw(); }
  };
  canvas.addEventListener("wheel", e => {
    e.preventDefault();
    const [dx, dy] = [e.offsetX * ratio() - canvas.width / 2, e.offsetY * ratio() - canvas.height / 2];
    view.zoomBy(Math.exp(-e.deltaY / 600), dx, dy);
    viewer.moved();
  }, { passive: false });
}

/** Handles keys on the canvas. */
function listenToKeys(viewer) {
  const { view } = viewer;
  const directions = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  $("canvas").onkeydown = e => {
    const direction = directions[e.key];
    if (direction && e.shiftKey) view.pan(...direction.map(x => 40 * x));
    else if (direction) view.rotate(...direction.map(x => x / 10));
    else if (["+", "=", "-"].includes(e.key)) view.zoomBy(e.key === "-" ? 0.8 : 1.25);
    else if (e.key === "Home") return viewer.reset();
    else return;
    e.preventDefault();
    viewer.moved();
  };
}

/** Moves the focus in a list of buttons with the arrow keys; only one button is a tab stop. */
function listenToList(list) {
  const buttons = () => [...list.querySelectorAll("button")];
  buttons().forEach((button, i) => { button.tabIndex = i === 0 ? 0 : -1; });
  list.onkeydown = e => {
    const all = buttons(), at = all.indexOf(document.activeElement);
    const to = { ArrowUp: at - 1, ArrowDown: at + 1, Home: 0, End: all.length - 1 }[e.key];
    if (at < 0 || !all[to]) return;
    e.preventDefault();
    all[at].tabIndex = -1;
    all[to].tabIndex = 0;
    all[to].focus();
  };
}
