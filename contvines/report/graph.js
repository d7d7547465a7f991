// A graph of branches: diagram, special points, attractors, one orbit at a time.
const branches = Object.fromEntries(data.branches.map((b) => [b.label, b]));
const points = Object.fromEntries(data.special.map((p) => [p.label, p]));
let here = null; // { branch, index, label }

// stable_points is null where stability is not computed
const state_at = (branch, i) => (!branch.stable_points ? "stability not computed" : branch.stable_points[i] ? "stable" : "unstable");

// ------------------------------------------------------------------ the diagram
function traces() {
  const x = $("x").value, y = $("y").value, found = [];
  data.branches.forEach((branch, k) => {
    if (!branch.real && !$("virtual").checked) return;
    const xs = branch.measures[x], ys = branch.measures[y];
    if (!xs || !ys) return;
    const color = (dark.matches ? light : colors)[k % colors.length];
    const about = xs.map((_, i) => `<b>${branch.label}</b> ${branch.what}<br>${x} = ${number(xs[i], 8)}<br>${y} = ${number(ys[i], 8)}<br>` +
      `${branch.real ? state_at(branch, i) : "virtual"}, point ${i}`);
    for (let first = 0; first < xs.length; ) {
      let last = first;
      const state = (i) => !branch.stable_points || (branch.stable_points[i] && branch.stable_points[i + 1]);
      while (last + 1 < xs.length - 1 && Boolean(state(last + 1)) === Boolean(state(first))) last += 1;
      const stop = Math.min(last + 1, xs.length - 1);
      const part = (v) => v.slice(first, stop + 1);
      const dash = !branch.real ? "dot" : state(first) || xs.length === 1 ? "solid" : "dash";
      found.push({ x: part(xs), y: part(ys), mode: "lines+markers", type: "scatter", line: { color, dash, width: dash === "solid" ? 2.4 : 1.6 },
        marker: { size: 4, color, opacity: 0.35 }, customdata: part(xs.map((_, i) => [branch.label, i])), text: part(about), hoverinfo: "text" });
      if (stop <= first) break;
      first = stop;
      if (first >= xs.length - 1) break;
    }
  });
  const marked = data.special.filter((p) => p.kind !== "end" && branches[p.branch] && branches[p.branch].measures[y] && p.index >= 0 &&
    (p.real || $("virtual").checked));
  found.push({ x: marked.map((p) => branches[p.branch].measures[x][p.index]), y: marked.map((p) => branches[p.branch].measures[y][p.index]),
    mode: "markers+text", type: "scatter", text: marked.map((p) => p.label), textposition: "top center", textfont: { size: 11, color: ink() },
    hovertext: marked.map((p) => `<b>${p.label}</b> ${p.name}<br>${data.parameter} = ${number(p.value[data.parameter], 12)}`), hoverinfo: "text",
    marker: { size: 10, symbol: marked.map((p) => shapes[p.marker] || "circle"), color: marked.map((p) =>
      (dark.matches ? light : colors)[data.branches.indexOf(branches[p.branch]) % colors.length]), line: { width: 1.4 } },
    customdata: marked.map((p) => [p.branch, p.index, p.label]) });
  if (here) {
    const branch = branches[here.branch];
    if (branch.measures[x] && branch.measures[y])
      found.push({ x: [branch.measures[x][here.index]], y: [branch.measures[y][here.index]], mode: "markers", type: "scatter", hoverinfo: "skip",
        marker: { size: 17, symbol: "circle-open", color: dark.matches ? "#ff9d5c" : "#b5531c", line: { width: 2.5 } } });
  }
  return found;
}
function draw(keep = true) {
  const old = $("diagram").layout;
  const range = (name) => (keep && old && old[name] && !old[name].autorange ? { range: old[name].range } : {});
  Plotly.react("diagram", traces(), layout({ xaxis: axis(data.names[$("x").value], range("xaxis")), yaxis: axis(data.names[$("y").value], range("yaxis")) }), options);
}

// ------------------------------------------------------------------ one orbit
function nearest(branch, index) {
  const known = data.orbits[branch] ? Object.keys(data.orbits[branch]).map(Number) : [];
  return known.length ? known.reduce((a, b) => (Math.abs(b - index) < Math.abs(a - index) ? b : a)) : null;
}
function choose(branch, index, label) {
  const about = branches[branch];
  index = Math.max(0, Math.min(index, about.points - 1));
  if (!label) label = (about.marks.find(([i]) => i === index) || [])[1];
  here = { branch, index, label };
  const special = label ? points[label] : null;
  $("orbit-title").textContent = special ? `${special.label}: ${special.name} on ${branch}` : `${branch}, point ${index}`;
  const value = about.measures[data.parameter][index];
  const sizes = (special ? special.multipliers : about.multipliers[index]) || [];
  const shown = sizes.filter(([re]) => re !== null).map(([re, im]) => (Math.abs(im) < 1e-15 ? number(re, 8) : `${number(re, 6)} ${im < 0 ? "−" : "+"} ${number(Math.abs(im), 6)}i`));
  const facts = [`${data.parameter} = ${number(special ? special.value[data.parameter] : value, 12)}`];
  if (about.word !== null) facts.unshift(`word ${about.word || "(stuck)"}`, `k = ${about.periods}`);
  const stable = special && special.marginal ? "marginal" : state_at(about, index);
  facts.push(about.real ? stable : "virtual: no machine can follow it");
  if (shown.length) facts.push(`multipliers ${shown.join(", ")}`);
  else if (sizes.length) facts.push("multipliers not defined at a graze");
  if (about.margin[index] !== null) facts.push(`smallest margin ${number(about.margin[index], 6)}`);
  if (special && special.criticality) facts.push(special.criticality);
  if (special && special.proof) facts.push(special.proof);
  if (special && special.note) facts.push(special.note);
  $("orbit-about").textContent = facts.join("; ");
  $("orbit-about").classList.toggle("virtual", !about.real);
  const name = special ? label : `${branch}:${index}`;
  $("command").textContent = `contvines orbit ${data.source} ${name}${data.trust ? " --trust" : ""}`;
  const file = `cv.load("${data.source}"${data.trust ? ", trust=True" : ""})`;
  $("python").textContent = special ? `${file}["${label}"].orbit` : `${file}["${branch}"].orbit(${index})`;
  document.querySelectorAll("tr.chosen").forEach((row) => row.classList.remove("chosen"));
  for (const id of [`row-${label}`, `row-${branch}`]) if ($(id)) $(id).classList.add("chosen");
  const place = nearest(branch, index);
  const scene = place === null ? null : data.orbits[branch][place];
  for (const id of ["portrait", "history", "stage"]) $(id).hidden = !scene;
  if (scene) show(scene);
  else stop();
  draw();
}

// ------------------------------------------------------------------ tables
function jump(branch, index, label) {
  started = true;
  choose(branch, index, label);
  $("diagram").scrollIntoView({ behavior: still.matches ? "auto" : "smooth", block: "start" });
}
table("special", ["point", "kind", "on", data.parameter, "", "leads to"], data.special, (p) => {
  const leads = data.switches.filter((s) => s.point === p.label).map((s) => `${s.from} → ${s.to}${s.note ? ` (${s.note})` : ""}`).join("; ");
  const row = cells(element("tr", undefined, { id: `row-${p.label}` }), [p.label, p.name, p.branch, number(p.value[data.parameter], 12),
    [p.criticality, p.proof || (p.real ? "" : "virtual")].filter(Boolean).join(" "), leads]);
  return p.index >= 0 && branches[p.branch] ? clickable(row, () => jump(p.branch, p.index, p.label)) : row;
});
const proofs = data.branches.some((b) => b.proof);
table("branches", ["branch", "what", data.parameter, "stable", ...(proofs ? ["proved"] : []), "points"], data.branches, (b) => {
  const row = cells(element("tr", undefined, { id: `row-${b.label}` }), [b.label,
    [b.what, b.periods === null ? "" : `k=${b.periods}`, b.symmetric ? "symmetric" : "", b.real ? "" : "virtual"].filter(Boolean).join(" "),
    `${number(b.range[0], 7)} … ${number(b.range[1], 7)}`, b.stable === null ? "not computed" : b.stable.map(([a, z]) => `${number(a, 7)} … ${number(z, 7)}`).join(", ") || "–", ...(proofs ? [b.proof || ""] : []), String(b.points)]);
  if (!b.real) row.className = "virtual";
  return clickable(row, () => jump(b.label, Math.floor(b.points / 2)));
});
made([...settled(data.model, "model"), [`${data.parameter} within`, data.within.map((v) => number(v)).join(" to ")], ...settled(data.settings, "setting"),
  ["run", data.finished ? data.message : "unfinished"]]);

// ------------------------------------------------------------------ the page
$("title").textContent = `${data.model.name || "problem"}: motions over ${data.names[data.parameter]}`;
$("about").textContent = `${many(data.branches, "branch", "branches")}, ${many(data.special, "special point", "special points")}` + (data.finished ? "" : ", unfinished") +
  (data.branches.some((b) => b.stable_points) ? "; solid lines are stable, dashed unstable" : "; stability is not computed") + ", dotted virtual (beyond a border).";
for (const id of ["x", "y"]) {
  for (const [name, text] of Object.entries(data.names)) $(id).append(element("option", text, { value: name }));
  $(id).value = data.axes[id];
  $(id).addEventListener("change", () => draw(false));
}
$("virtual").closest("label").hidden = data.branches.every((b) => b.real);
$("virtual").addEventListener("change", () => draw());
$("reset").addEventListener("click", () => draw(false));
draw(false);
$("diagram").on("plotly_afterplot", thin);
thin();
$("diagram").on("plotly_click", (event) => {
  const found = event.points.find((p) => p.customdata);
  if (found) { started = true; choose(...found.customdata); }
});
$("diagram").addEventListener("keydown", (event) => {
  const labels = data.branches.map((b) => b.label);
  if (!here) here = { branch: labels[0], index: 0 };
  const step = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] }[event.key];
  if (!step) return;
  event.preventDefault();
  const k = (labels.indexOf(here.branch) + step[1] + labels.length) % labels.length;
  choose(labels[k], step[1] ? 0 : here.index + step[0]);
});
dark.addEventListener("change", () => (here ? choose(here.branch, here.index, here.label) : draw()));
const telling = ["symmetry-breaking", "period-doubling", "neimark-sacker", "hopf", "fold"];
const rank = (p) => (telling.includes(p.kind) ? telling.indexOf(p.kind) : telling.length);
const first = data.special.filter((p) => p.kind !== "end" && p.index >= 0).sort((a, b) => rank(a) - rank(b))[0] || null;
if (first) choose(first.branch, first.index, first.label);
else if (data.branches.length) choose(data.branches[0].label, 0);
started = true;
