// Overlays of the view: axes and scale bar.

/** Length of an axis, in units of the SVG viewport. */
const AXIS_LENGTH = 28;
/** Maximum length of the scale bar, in pixels. */
const SCALE_BAR_PIXELS = 140;

/** Appends the length unit, if it is known. */
const withUnit = text => facts.unit ? `${text} ${facts.unit}` : text;

/** Largest 1, 2 or 5 times a power of ten that does not exceed `most`. */
function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find(digit => digit * power <= most) * power;
}

/** Updates both overlays. `pixels`: CSS pixels per unit of length. */
function drawOverlays(view, pixels) {
  const groups = [0, 1, 2].map(k => {
    const group = document.querySelector(`#triad .${"xyz"[k]}`);
    const [x, y] = [AXIS_LENGTH * view.right[k], -AXIS_LENGTH * view.up[k]];
    const line = group.querySelector("line"), label = group.querySelector("text");
    line.setAttribute("x2", x.toFixed(1));
    line.setAttribute("y2", y.toFixed(1));
    // Labels of axes along the view direction move off the origin.
    label.setAttribute("x", (1.28 * x + (Math.hypot(x, y) < 4 ? -9 : 0)).toFixed(1));
    label.setAttribute("y", (1.28 * y + (Math.hypot(x, y) < 4 ? 9 : 0)).toFixed(1));
    return [view.towards[k], group];
  });
  // Axes that point towards the viewer cover the others.
  const sorted = groups.sort((a, b) => a[0] - b[0]).map(([, group]) => group);
  if (sorted.some((group, i) => group !== $("triad").children[i])) $("triad").append(...sorted);
  const length = roundLength(SCALE_BAR_PIXELS / pixels), bar = $("scale-bar");
  bar.style.width = `${(length * pixels).toFixed(1)}px`;
  bar.firstElementChild.textContent = withUnit(number(length));
  bar.setAttribute("aria-label", `Scale bar: ${bar.textContent}`);
}
