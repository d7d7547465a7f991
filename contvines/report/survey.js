// A survey: an outcome over what varies, with bands of what is uncertain, or as a map; the machines behind a point as a table.
const axes = Object.keys(data.axes), names = Object.keys(data.parameters), outcomes = Object.keys(data.columns);
const count = data.notes.length;
const MAP = " × ";
let here = null; // index of a machine

// ------------------------------------------------------------------ the picture
const label = (name) => data.names[name] || name;
const told = (i) => names.map((n) => `${n} = ${number(data.parameters[n][i], 6)}`).join("<br>");
const quantile = (sorted, share) => {
  const at = share * (sorted.length - 1), i = Math.floor(at), j = Math.min(i + 1, sorted.length - 1);
  return sorted[i] + (at - i) * (sorted[j] - sorted[i]);
};
function groups(name) {
  const values = [...new Set(data.parameters[name])].sort((a, b) => a - b), column = data.columns[$("outcome").value];
  return [values, values.map((v) => column.filter((y, i) => y !== null && data.parameters[name][i] === v).sort((a, b) => a - b))];
}
function dots(over) {
  const y = data.columns[$("outcome").value], kept = [...Array(count).keys()].filter((i) => y[i] !== null);
  const color = dark.matches ? light[0] : colors[0];
  return { type: "scatter", mode: "markers", x: kept.map((i) => data.parameters[over][i]), y: kept.map((i) => y[i]), customdata: kept, marker: { size: 6, color, opacity: 0.55 },
    text: kept.map((i) => `${told(i)}<br><b>${$("outcome").value} = ${number(y[i], 7)}</b>`), hoverinfo: "text", name: "machines" };
}
function traces() {
  const over = $("over").value, y = data.columns[$("outcome").value], color = dark.matches ? light[0] : colors[0], accent = dark.matches ? "#ff9d5c" : "#b5531c";
  if (over.includes(MAP)) {
    const [a, b] = axes, xs = data.axes[a], ys = data.axes[b], samples = count / (xs.length * ys.length);
    const cell = (i, j) => Array.from({ length: samples }, (_, k) => (i * ys.length + j) * samples + k);
    const worst = (i, j) => cell(i, j).reduce((best, k) => (y[k] !== null && (best === null || y[k] > best) ? y[k] : best), null);
    const grid = ys.map((_, j) => xs.map((_, i) => worst(i, j)));
    const found = [{ type: "heatmap", x: xs, y: ys, z: grid, colorscale: "Viridis", colorbar: { title: { text: data.samples.length ? "worst sample" : "" } },
      customdata: ys.map((_, j) => xs.map((_, i) => cell(i, j).find((k) => y[k] === worst(i, j)) ?? cell(i, j)[0])),
      hovertemplate: `${a} = %{x:.6g}<br>${b} = %{y:.6g}<br><b>%{z:.6g}</b><extra></extra>` }];
    if (here !== null) found.push({ type: "scatter", mode: "markers", x: [data.parameters[a][here]], y: [data.parameters[b][here]], hoverinfo: "skip", showlegend: false, marker: { size: 17, symbol: "circle-open", color: accent, line: { width: 2.5 } } });
    return found;
  }
  const found = [];
  const [xs, known] = groups(over), full = known.every((g) => g.length);
  if (axes.includes(over) && count > xs.length && full) {
    const band = (low, high, opacity, name) => [
      { type: "scatter", mode: "lines", x: xs, y: known.map((g) => quantile(g, low)), line: { width: 0, color }, hoverinfo: "skip", showlegend: false },
      { type: "scatter", mode: "lines", x: xs, y: known.map((g) => quantile(g, high)), line: { width: 0, color }, fill: "tonexty", fillcolor: `rgba(80,130,190,${opacity})`, hoverinfo: "skip", name }];
    found.push(...band(0, 1, 0.18, "all machines"), ...band(0.25, 0.75, 0.35, "half of them"),
      { type: "scatter", mode: "lines", x: xs, y: known.map((g) => quantile(g, 0.5)), line: { color, width: 2.2 }, name: "median", hoverinfo: "skip" });
  } else if (axes.includes(over)) found.push({ type: "scatter", mode: "lines", x: xs, y: known.map((g) => (g.length ? quantile(g, 0.5) : null)), line: { color, width: 1.8 }, name: "median", hoverinfo: "skip" });
  found.push(dots(over));
  if (here !== null && y[here] !== null)
    found.push({ type: "scatter", mode: "markers", x: [data.parameters[over][here]], y: [y[here]], hoverinfo: "skip", showlegend: false, marker: { size: 17, symbol: "circle-open", color: accent, line: { width: 2.5 } } });
  return found;
}
function draw() {
  const over = $("over").value, map = over.includes(MAP);
  Plotly.react("diagram", traces(), layout({ showlegend: !map, legend: { orientation: "h", y: 1.1 }, margin: { l: 72, r: 12, t: 26, b: 46 },
    xaxis: axis(label(map ? axes[0] : over)), yaxis: axis(label(map ? axes[1] : $("outcome").value)) }), options);
}

// ------------------------------------------------------------------ one machine, and those that differ in samples only
function choose(i) {
  here = Math.max(0, Math.min(i, count - 1));
  const same = [...Array(count).keys()].filter((k) => axes.every((a) => data.parameters[a][k] === data.parameters[a][here]));
  $("system-title").textContent = axes.length ? axes.map((a) => `${a} = ${number(data.parameters[a][here], 8)}`).join(", ") + `: ${many(same, "machine", "machines")}` : `machine ${here + 1} of ${count}`;
  $("chosen").tHead.replaceChildren();
  $("chosen").tBodies[0].replaceChildren();
  const shown = axes.length ? same.slice(0, 200) : [here];
  table("chosen", ["", ...names, ...outcomes, "note"], shown, (k) => {
    const row = clickable(cells(element("tr", undefined, { id: `system-${k}` }), [String(k + 1), ...names.map((n) => number(data.parameters[n][k], 7)), ...outcomes.map((c) => number(data.columns[c][k], 7)), data.notes[k]]), () => choose(k));
    if (k === here) row.className = "chosen";
    return row;
  });
  draw();
}
const known = (name) => data.columns[name].filter((v) => v !== null).sort((a, b) => a - b);
table("outcomes", ["outcome", "smallest", "median", "largest", "unit", "at the smallest"], outcomes, (name) => {
  const values = known(name), least = data.columns[name].indexOf(values[0]);
  const row = cells(element("tr"), [label(name), ...(values.length ? [0, 0.5, 1].map((s) => number(quantile(values, s), 7)) : ["–", "–", "–"]), data.units[name] || "",
    least < 0 ? "" : names.map((n) => `${n} ${number(data.parameters[n][least], 5)}`).join(", ")]);
  return clickable(row, () => { $("outcome").value = name; choose(Math.max(least, 0)); $("diagram").scrollIntoView({ block: "start" }); });
});
const noted = [...Array(count).keys()].filter((i) => data.notes[i]), partly = noted.length - data.failed;
$("failures").hidden = !noted.length;
table("failed", ["", ...names, "why"], noted.slice(0, 500), (i) => clickable(cells(element("tr"), [String(i + 1), ...names.map((n) => number(data.parameters[n][i], 7)), data.notes[i]]), () => choose(i)));
made(settled(data.about, "survey"));

// ------------------------------------------------------------------ the page
$("title").textContent = `survey over ${names.join(", ")}`;
$("about").textContent = `${count} machines` + (data.failed ? `, ${data.failed} of them failed` : "") + (partly ? `, ${partly} known in part` : "") + (data.samples.length ? `; uncertain: ${data.samples.join(", ")}` : "") + ".";
for (const name of outcomes) $("outcome").append(element("option", label(name), { value: name }));
const choices = axes.length === 2 ? [axes.join(MAP), ...names] : names;
for (const name of choices) $("over").append(element("option", name.includes(MAP) ? `${name} (map)` : label(name), { value: name }));
for (const id of ["outcome", "over"]) $(id).addEventListener("change", draw);
$("reset").addEventListener("click", () => { Plotly.relayout("diagram", { "xaxis.autorange": true, "yaxis.autorange": true }); });
draw();
$("diagram").on("plotly_click", (event) => {
  const found = event.points.find((entry) => entry.customdata !== undefined);
  if (found) choose(Number(found.customdata));
});
$("diagram").addEventListener("keydown", (event) => {
  const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!step) return;
  event.preventDefault();
  choose(here === null ? 0 : here + step);
});
dark.addEventListener("change", draw);
choose(0);
