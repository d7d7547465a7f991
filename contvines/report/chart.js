// A chart: loci, points and regions in the plane of two parameters, one motion at a time.
const [p, q] = data.parameters;
const loci = Object.fromEntries(data.loci.map((l) => [l.label, l]));
const kinds = [...new Set(data.loci.map((l) => l.name))];
const tint = ["#dbe9f6", "#fbe3d6", "#e3f1e0", "#efe4f5", "#fdf3cf", "#d9f0f0", "#f6dfe6", "#e9e9e4"];
const shade = ["#1d3550", "#4a3022", "#24402b", "#38294a", "#4a4220", "#1f4444", "#472a36", "#3a3a36"];
const hatches = [null, "line-ne-open", "circle", "line-nw-open", "line-ew-open", "x-thin-open", "line-ns-open", "cross-thin-open"]; // as in plots/chart.py
const file = `cv.load("${data.source}"${data.trust ? ", trust=True" : ""})`;
let here = null; // { locus, index } or { point }

// ------------------------------------------------------------------ the plane
const colorOf = (locus) => (dark.matches ? light : colors)[kinds.indexOf(locus.name) % colors.length];
function traces() {
  const found = [];
  if ($("tints").checked && data.regions.length) {
    const palette = dark.matches ? shade : tint, names = [...new Set(data.regions.map((r) => r.name))], n = Math.max(names.length, 2);
    const scale = names.flatMap((_, k) => [[k / n, palette[k % palette.length]], [(k + 1) / n, palette[k % palette.length]]]);
    if (names.length === 1) scale.push([0.5, palette[0]], [1, palette[0]]);
    const index = data.regions.map((r) => names.indexOf(r.name) + 0.5);
    const z = (data.raster[0] || []).map((_, j) => data.raster.map((row) => (row[j] < 0 ? null : index[row[j]])));
    found.push({ type: "heatmap", x0: data.corner[0], dx: data.cell[0], y0: data.corner[1], dy: data.cell[1], z, zmin: 0, zmax: n, colorscale: scale, showscale: false, hoverinfo: "skip" });
    // marks on a grid of the cells, alike where the same is stable: regions are told apart without colours, too
    const every = Math.max(1, Math.round(z.length / 45));
    names.forEach((_, k) => {
      const symbol = hatches[k % hatches.length], x = [], y = [];
      if (!symbol) return;
      z.forEach((row, i) => row.forEach((value, j) => {
        if (value === k + 0.5 && i % every === 0 && j % every === 0) { x.push(data.corner[0] + j * data.cell[0]); y.push(data.corner[1] + i * data.cell[1]); }
      }));
      found.push({ type: "scatter", mode: "markers", x, y, hoverinfo: "skip", showlegend: false, marker: { symbol, size: symbol === "circle" ? 2 : 7, color: dark.matches ? "#8a8a8a" : "#a8a8a8", line: { width: 0.8, color: dark.matches ? "#8a8a8a" : "#a8a8a8" } } });
    });
    const named = data.regions.filter((r) => r.share > 0.012);
    found.push({ type: "scatter", mode: "text", x: named.map((r) => r.at[p]), y: named.map((r) => r.at[q]), text: named.map((r) => r.short),
      textfont: { size: 10, color: ink() }, hoverinfo: "skip", showlegend: false });
  }
  const seen = new Set();
  for (const locus of data.loci) {
    for (let first = 0; first < locus.p.length - 1; ) {
      const state = (i) => locus.real[i] && locus.real[i + 1];
      let last = first + 1;
      while (last < locus.p.length - 1 && state(last) === state(first)) last += 1;
      const part = (v) => v.slice(first, last + 1);
      if (state(first) || $("virtual").checked)
        found.push({ type: "scatter", mode: "lines+markers", x: part(locus.p), y: part(locus.q), name: locus.name, legendgroup: locus.name, showlegend: false,
          line: { color: colorOf(locus), width: locus.border ? 1.4 : 2.4, dash: state(first) ? (locus.border ? "dash" : "solid") : "dot" }, marker: { size: 4, opacity: 0.01, color: colorOf(locus) },
          customdata: part(locus.p.map((_, i) => [locus.label, i])), hoverinfo: "text",
          text: part(locus.p.map((v, i) => `<b>${locus.label}</b> ${locus.name}<br>${p} = ${number(v, 8)}<br>${q} = ${number(locus.q[i], 8)}${locus.real[i] ? "" : "<br>virtual"}`)) });
      first = last;
    }
    // the kind's mark at a third and two thirds, for those who see no colours
    const spots = [1 / 3, 2 / 3].map((share) => Math.round(share * (locus.p.length - 1))).filter((i) => locus.real[i]);
    found.push({ type: "scatter", mode: "lines+markers", x: spots.flatMap((i) => [locus.p[i], null]), y: spots.flatMap((i) => [locus.q[i], null]), name: locus.name, legendgroup: locus.name,
      showlegend: !seen.has(locus.name), line: { color: colorOf(locus), width: locus.border ? 1.4 : 2.4, dash: locus.border ? "dash" : "solid" }, hoverinfo: "skip",
      marker: { size: 8, color: colorOf(locus), symbol: shapes[locus.marker] || "circle", line: { width: 1.4 } } });
    seen.add(locus.name);
  }
  const marked = data.points.filter((point) => point.real || $("virtual").checked);
  found.push({ type: "scatter", mode: "markers+text", x: marked.map((m) => m.value[p]), y: marked.map((m) => m.value[q]), text: marked.map((m) => m.label), textposition: "top center",
    textfont: { size: 11, color: ink() }, marker: { size: 9, color: ink() }, showlegend: false, customdata: marked.map((m) => [null, null, m.label]), hoverinfo: "text",
    hovertext: marked.map((m) => `<b>${m.label}</b> ${m.name}<br>${p} = ${number(m.value[p], 10)}<br>${q} = ${number(m.value[q], 10)}`) });
  if (here) {
    const at = here.point ? [here.point.value[p], here.point.value[q]] : [loci[here.locus].p[here.index], loci[here.locus].q[here.index]];
    found.push({ type: "scatter", mode: "markers", x: [at[0]], y: [at[1]], hoverinfo: "skip", showlegend: false, marker: { size: 17, symbol: "circle-open", color: dark.matches ? "#ff9d5c" : "#b5531c", line: { width: 2.5 } } });
  }
  return found;
}
function draw(keep = true) {
  const old = $("diagram").layout;
  const range = (name, own) => ({ range: keep && old && old[name] ? old[name].range : own });
  Plotly.react("diagram", traces(), layout({ showlegend: true, legend: { orientation: "h", y: 1.02, yanchor: "bottom" },
    xaxis: axis(data.names[p], range("xaxis", data.within[0])), yaxis: axis(data.names[q], range("yaxis", data.within[1])) }), options);
}

// ------------------------------------------------------------------ one motion
function tell(title, facts, name, python, scene, rows) {
  $("orbit-title").textContent = title;
  $("orbit-about").textContent = facts.filter(Boolean).join("; ");
  $("command").textContent = `contvines show ${data.source} --json`;
  $("python").textContent = python;
  document.querySelectorAll("tr.chosen").forEach((row) => row.classList.remove("chosen"));
  for (const id of rows) if ($(id)) $(id).classList.add("chosen");
  for (const id of ["portrait", "history", "stage"]) $(id).hidden = !scene;
  if (scene) show(scene);
  else stop();
  draw();
}
function choose(label, index) {
  const locus = loci[label];
  index = Math.max(0, Math.min(index, locus.p.length - 1));
  here = { locus: label, index };
  const known = Object.keys(data.orbits[label] || {}).map(Number);
  const place = known.length ? known.reduce((a, b) => (Math.abs(b - index) < Math.abs(a - index) ? b : a)) : null;
  tell(`${label}: ${locus.name}, point ${index}`, [`${p} = ${number(locus.p[index], 12)}`, `${q} = ${number(locus.q[index], 12)}`, locus.word === null ? "" : `word ${locus.word || "(stuck)"}`,
    locus.real[index] ? "" : "virtual: no machine can follow it"], label, `${file}["${label}"].orbit(${index})`, place === null ? null : data.orbits[label][place], [`row-${label}`]);
}
function point(label) {
  const one = data.points.find((m) => m.label === label);
  here = { point: one };
  tell(`${label}: ${one.name}`, [`${p} = ${number(one.value[p], 12)}`, `${q} = ${number(one.value[q], 12)}`, `on ${one.on.join(", ")}`,
    ...Object.entries(one.coefficients).map(([k, v]) => `${k} = ${number(v, 6)}`), one.real ? "" : "virtual", one.note], label,
  `${file}["${label}"].orbit`, one.scene, [`row-${label}`, ...one.on.map((l) => `row-${l}`)]);
}
const jump = (act) => { started = true; act(); $("diagram").scrollIntoView({ behavior: still.matches ? "auto" : "smooth", block: "start" }); };

// ------------------------------------------------------------------ tables
table("loci", ["locus", "kind", p, q, "from", "ends"], data.loci, (l) => clickable(cells(element("tr", undefined, { id: `row-${l.label}` }),
  [l.label, l.name, `${number(Math.min(...l.p), 6)} … ${number(Math.max(...l.p), 6)}`, `${number(Math.min(...l.q), 6)} … ${number(Math.max(...l.q), 6)}`, l.seed || "", l.ended.join(" | ")]),
() => jump(() => choose(l.label, Math.floor(l.p.length / 2)))));
table("points", ["point", "kind", "on", p, q, "coefficients"], data.points, (m) => clickable(cells(element("tr", undefined, { id: `row-${m.label}` }),
  [m.label, m.name + (m.real ? "" : " (virtual)"), m.on.join(", "), number(m.value[p], 10), number(m.value[q], 10), Object.entries(m.coefficients).map(([k, v]) => `${k} ${number(v, 5)}`).join(", ")]),
() => jump(() => point(m.label))));
table("regions", ["a simulation settles on", p, q, "share of the plane"], data.regions, (r) => cells(element("tr"), [r.name, number(r.at[p], 6), number(r.at[q], 6), `${number(100 * r.share, 3)} %`]));
made([...settled(data.model, "model"), [`${p} within`, data.within[0].map((v) => number(v)).join(" to ")], [`${q} within`, data.within[1].map((v) => number(v)).join(" to ")],
  ...settled(data.settings, "setting"), ["run", data.finished ? data.message : "unfinished"]]);

// ------------------------------------------------------------------ the page
$("title").textContent = `${data.model.name || "problem"}: ${data.names[p]} and ${data.names[q]}`;
$("about").textContent = [many(data.loci, "locus", "loci"), many(data.points, "point of codimension two", "points of codimension two"), many(data.regions, "region", "regions")].join(", ") + (data.finished ? "" : ", unfinished") +
  "; heavy lines are bifurcations, dashed ones borders, dotted ones virtual; tints and hatches tell what a simulation settles on.";
$("virtual").closest("label").hidden = data.loci.every((l) => l.real.every(Boolean));
$("tints").closest("label").hidden = !data.regions.length;
for (const id of ["virtual", "tints"]) $(id).addEventListener("change", () => draw());
$("reset").addEventListener("click", () => draw(false));
draw(false);
$("diagram").on("plotly_afterplot", thin);
thin();
$("diagram").on("plotly_click", (event) => {
  const found = event.points.find((entry) => entry.customdata);
  if (!found) return;
  started = true;
  if (found.customdata[2]) point(found.customdata[2]);
  else choose(...found.customdata);
});
$("diagram").addEventListener("keydown", (event) => {
  const labels = data.loci.map((l) => l.label), step = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] }[event.key];
  if (!step || !labels.length) return;
  event.preventDefault();
  if (!here || here.point) return choose(labels[0], 0);
  const k = (labels.indexOf(here.locus) + step[1] + labels.length) % labels.length;
  choose(labels[k], step[1] ? 0 : here.index + step[0]);
});
dark.addEventListener("change", () => (here && here.locus ? choose(here.locus, here.index) : here ? point(here.point.label) : draw()));
if (data.loci.length) choose(data.loci[0].label, Math.floor(data.loci[0].p.length / 2));
started = true;
