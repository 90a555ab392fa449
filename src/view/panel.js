// Panel: sizes, legend, banner, faults.

const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};
const count = (n, noun) => `${n.toLocaleString("en")} ${noun}${n === 1 ? "" : "s"}`;

/** Legend entry of a colour. */
function swatch(colour, name) {
  const box = make("i");
  box.style.background = `rgb(${colour})`;
  return make("span", {}, box, name);
}

/** Colour bar with labels at equal distances. */
function colourBar(colours, labels, title) {
  const bar = make("div", { className: "gradient" });
  bar.style.background = `linear-gradient(to right, ${colours.map(c => `rgb(${c})`).join(",")})`;
  return [make("p", { textContent: title }), bar, make("div", { className: "ticks" }, ...labels.map(text => make("span", {}, text)))];
}

/** Names of the patches by colour: kinds with a fixed colour, and up to three of each other colour. */
function patchSwatches(ids) {
  const byColour = new Map();
  for (const id of ids) {
    const colour = patchColour(id), kind = patchKind(id), names = byColour.get(String(colour)) || new Set();
    names.add(kind);
    byColour.set(String(colour), names);
  }
  return [...byColour].map(([colour, names]) => {
    const [shown, hidden] = [[...names].slice(0, 3), names.size - 3];
    return swatch(colour, shown.join(", ") + (hidden > 0 ? ` and ${hidden} more` : ""));
  });
}

/** Legend of the colours by a quantity. */
function legendOf(quantity, scene) {
  const shades = Array.from({ length: 9 }, (_, i) => viridis(i / 8));
  const inside = facts.tets && facts.tets.shown > 0 && regions.size === 0 && ["patch", "radius", "order", "value"].includes(quantity)
    ? [swatch(PALETTE.inside, "clipped tetrahedra")] : [];
  if (quantity === "radius") {
    const [low, high] = (facts.wall || facts.network).radii;
    return [...colourBar(shades, [low, Math.sqrt(low * high), high].map(x => number(x, 3)), `Vessel radius${facts.unit ? ` in ${facts.unit}` : ""} (logarithmic)`), ...inside];
  }
  if (quantity === "value") {
    const { name, unit, scale: { low, high, logarithmic } } = facts.data;
    const labels = [low, logarithmic ? Math.sqrt(low * high) : (low + high) / 2, high].map(x => number(x, 3));
    return [...colourBar(shades, labels, `${name}${unit ? ` in ${unit}` : ""}${logarithmic ? " (logarithmic)" : ""}`), ...inside];
  }
  if (quantity === "order") {
    const most = facts.network.orders, colours = Array.from({ length: most }, (_, i) => viridis(most > 1 ? i / (most - 1) : 0.5));
    return [make("p", { textContent: "Strahler order" }), ...colours.map((colour, i) => swatch(colour, String(i + 1))), ...inside];
  }
  if (quantity === "quality") return colourBar(QUALITY, ["0", "0.25", "0.5", "0.75", "1"], "Radius ratio (1: regular)");
  if (quantity === "region") return [...regions.values()].map(({ id, name }) => swatch(regionColour(id), name));
  if (quantity === "patch") return [...patchSwatches(new Set(scene.groups.patch)), ...inside];
  const blocks = scene.groups ? new Set(scene.groups.block).size : new Set(scene.network.branches).size;
  return [make("p", { textContent: `${count(blocks, scene.groups ? "block" : "vessel")}; hues have no order` })];
}

/** Groups of faults as lists; a button of a list shows its fault. */
function listFaults(show) {
  const groups = facts.faults || [];
  const total = groups.reduce((sum, group) => sum + group.count, 0);
  $("faults").hidden = groups.length === 0;
  $("faults").querySelector("h2").textContent = count(total, "fault");
  groups.forEach((group, i) => {
    const items = group.faults.map(fault => {
      const button = make("button", { type: "button", textContent: fault.what });
      button.onclick = () => show(fault, button, group);
      return make("li", {}, button);
    });
    const list = make("ol", {}, ...items), hidden = group.count - group.faults.length;
    listenToList(list);
    const more = hidden > 0 ? [make("p", { textContent: `${hidden.toLocaleString("en")} more ${group.faults.length ? "are not listed" : "without a position"}` })] : [];
    const title = make("summary", { textContent: `${group.kind} (${group.count.toLocaleString("en")})` });
    $("faults").append(make("details", { open: i === 0 }, title, list, ...more));
  });
  return total;
}

/** Switches of the regions. */
function listRegions(toggle) {
  $("regions").hidden = regions.size === 0;
  for (const { id, name } of regions.values()) {
    const box = make("input", { type: "checkbox", checked: true });
    box.onchange = () => toggle(id, box.checked);
    $("regions").append(make("label", {}, box, " ", swatch(regionColour(id), name)));
  }
}

/** Verdict: a banner if the mesh has faults or was not checked, otherwise a line in the panel. */
function showVerdict(faults) {
  const { check } = facts, banner = $("banner");
  if (check && check.verdict === "valid" && faults === 0) {
    $("counts").after(make("p", { id: "verdict", className: "good", textContent: "✓ valid" }));
    return;
  }
  const found = faults > 0 ? `: ${count(faults, "fault")}` : "";
  const text = check && check.verdict === "invalid" ? `NOT valid${found}` : check ? check.text + found : found.slice(2);
  banner.hidden = text === "";
  banner.textContent = text;
  banner.className = faults > 0 || (check && check.verdict === "invalid") ? "" : "warn";
}

/** Fills the panel. */
function fillPanel(viewer) {
  const { wall, tets } = viewer;
  $("title").textContent = document.title = facts.title;
  const sizes = wall
    ? [...(facts.tets && facts.tets.all ? [facts.tets.all === 1 ? "1 tetrahedron" : `${facts.tets.all.toLocaleString("en")} tetrahedra`] : []),
      count(facts.wall.faces, "boundary face"), ...(wall.triangles === facts.wall.faces ? [] : [`${wall.triangles.toLocaleString("en")} shown`])]
    : [count(facts.network.edges, "edge")];
  $("counts").textContent = sizes.join(", ");
  const quantities = wall ? [...(regions.size > 0 ? ["region"] : []), "patch", ...(regions.size > 0 ? [] : ["block"]), "quality", ...(facts.wall.radii ? ["radius", "order"] : [])] : ["radius", "order", "vessel"];
  if (facts.data) quantities.unshift("value");
  $("colour").append(...quantities.map(name => make("option", { textContent: name === "value" ? facts.data.name : name, value: name === "vessel" ? "block" : name })));
  $("edges").checked = !!wall && facts.wall.exact && wall.triangles < 60000;
  $("edges-label").hidden = !wall;
  $("tets").hidden = !(tets && facts.tets.shown < facts.tets.all);
  if (!$("tets").hidden) {
    const [axis, at] = facts.tets.plane;
    $("tets").textContent = `The page contains ${facts.tets.shown.toLocaleString("en")} tetrahedra, at ${"xyz"[axis]} = ${number(at)}. Elsewhere a clip plane shows the wall only.`;
  }
  listRegions((id, isOn) => viewer.toggle(id, isOn));
  showVerdict(listFaults((fault, button, group) => viewer.flyTo(fault, button, group)));
}

function collapsePanel(isCollapsed) {
  $("panel").classList.toggle("collapsed", isCollapsed);
  $("toggle").setAttribute("aria-expanded", String(!isCollapsed));
}

/** Handles the controls of the panel. */
function listenToPanel(viewer) {
  $("toggle").onclick = () => collapsePanel(!$("panel").classList.contains("collapsed"));
  $("colour").onchange = () => viewer.colour();
  $("axis").onchange = () => viewer.chooseClipAxis();
  $("place").oninput = () => viewer.clip();
  $("edges").onchange = () => viewer.redraw();
  $("reset").onclick = () => viewer.reset();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  $("theme").onclick = () => {
    const root = document.documentElement.classList, isDark = root.contains("dark") || (dark.matches && !root.contains("light"));
    root.toggle("dark", !isDark);
    root.toggle("light", isDark);
    viewer.redraw();
  };
  dark.addEventListener("change", () => viewer.redraw());
  new ResizeObserver(() => viewer.redraw()).observe($("canvas"));
}
