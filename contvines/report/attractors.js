// What simulated starts settle on, over the parameter: bars of shares, and a table whose rows lead to the branch.
function attractors() {
  const places = (of) => [...new Set(of.map((a) => a.value))].sort((a, b) => a - b);
  const known = data.attractors, all = places(known), values = places(known.filter((a) => a.starts)), most = colors.length;
  const sizes = new Map();
  known.forEach((a) => sizes.set(a.name, (sizes.get(a.name) || 0) + a.share));
  const names = [...sizes.keys()], large = new Set([...names].sort((a, b) => sizes.get(b) - sizes.get(a)).slice(0, most));
  const edge = (i) => (i === 0 ? data.within[0] : i === values.length ? data.within[1] : 0.5 * (values[i - 1] + values[i]));
  $("shares").hidden = false;
  const bars = (name, own, color) => ({ type: "bar", name, x: values.map((_, i) => 0.5 * (edge(i) + edge(i + 1))), width: values.map((_, i) => edge(i + 1) - edge(i)), customdata: values,
    y: values.map((v) => known.filter((a) => a.value === v && own(a.name)).reduce((sum, a) => sum + a.share, 0)),
    marker: { color, line: { width: 0 } }, hovertemplate: `${name}: %{y:.1%}<br>${data.parameter} = %{customdata:.6g}<extra></extra>` });
  const paint = () => {
    const found = names.filter((name) => large.has(name)).map((name, k) => bars(name, (n) => n === name, (dark.matches ? light : colors)[k % colors.length]));
    if (names.length > most) found.push(bars("others", (n) => !large.has(n), "#8a8a8a"));
    Plotly.react("share", found, layout({ barmode: "stack", bargap: 0, showlegend: true, legend: { font: { size: 11 }, orientation: "h", y: 1.02, yanchor: "bottom" },
      xaxis: axis(data.names[data.parameter], { range: data.within }), yaxis: axis("share of the starts", { range: [0, 1.02] }) }), options);
  };
  paint();
  dark.addEventListener("change", paint);
  const nearest = (label, value) => {
    const xs = branches[label].measures[data.parameter];
    return xs.reduce((best, v, i) => ((!branches[label].stable_points || branches[label].stable_points[i]) && Math.abs(v - value) < Math.abs(xs[best] - value) ? i : best), xs.length >> 1);
  };
  // a row stands for neighbouring values at which the same motion was met
  const rows = [], open = new Map();
  [...known].sort((a, b) => a.value - b.value).forEach((a) => {
    const key = JSON.stringify([a.name, a.kind, a.branch]), i = all.indexOf(a.value), row = open.get(key);
    if (row && i - row.last <= 1) Object.assign(row, { last: i, entries: [...row.entries, a] });
    else { const made = { last: i, entries: [a] }; open.set(key, made); rows.push(made); }
  });
  const span = (low, high, digits) => (low === high ? number(low, digits) : `${number(low, digits)} … ${number(high, digits)}`);
  table("attractors", [data.parameter, "motion", "kind", "branch", "share of the starts"], rows, ({ entries }) => {
    const a = entries[entries.length >> 1], counted = entries.filter((e) => e.starts), shares = counted.map((e) => 100 * e.share), starts = entries.reduce((sum, e) => sum + e.starts, 0);
    const row = cells(element("tr"), [span(entries[0].value, entries[entries.length - 1].value, 8), a.name, a.kind, a.branch || "–",
      counted.length ? `${span(Math.min(...shares), Math.max(...shares), 4)} % of ${starts}${counted.length > 1 ? ` at ${counted.length} values` : ""}` : "followed there"]);
    return a.branch && branches[a.branch] ? clickable(row, () => jump(a.branch, nearest(a.branch, a.value))) : row;
  });
}
if (data.attractors.length) attractors();
