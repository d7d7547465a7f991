// What simulated starts settle on, over the parameter: bars of shares, and a table whose rows lead to the branch.
function attractors() {
  const known = data.attractors, names = [...new Set(known.map((a) => a.name))], values = [...new Set(known.map((a) => a.value))].sort((a, b) => a - b);
  $("shares").hidden = false;
  const paint = () => Plotly.react("share", names.map((name, k) => ({ type: "bar", name, x: values.map((_, i) => i), customdata: values,
    y: values.map((v) => known.filter((a) => a.value === v && a.name === name).reduce((sum, a) => sum + a.share, 0)),
    marker: { color: (dark.matches ? light : colors)[k % colors.length], pattern: { shape: ["", "/", "x", "."][Math.floor(k / colors.length) % 4] } },
    hovertemplate: `${name}: %{y:.1%}<br>${data.parameter} = %{customdata:.6g}<extra></extra>` })),
  layout({ barmode: "stack", showlegend: true, legend: { font: { size: 11 } }, xaxis: axis(data.names[data.parameter],
    { tickvals: values.map((_, i) => i), ticktext: values.map((v) => number(v, 4)) }), yaxis: axis("share of the starts", { range: [0, 1.02] }) }), options);
  paint();
  dark.addEventListener("change", paint);
  const nearest = (label, value) => {
    const xs = branches[label].measures[data.parameter];
    return xs.reduce((best, v, i) => (branches[label].stable_points[i] && Math.abs(v - value) < Math.abs(xs[best] - value) ? i : best), xs.length >> 1);
  };
  table("attractors", [data.parameter, "motion", "kind", "branch", "share of the starts"], known, (a) => {
    const row = cells(element("tr"), [number(a.value, 8), a.name, a.kind, a.branch || "–", `${number(100 * a.share, 4)} % of ${a.starts}`]);
    return a.branch && branches[a.branch] ? clickable(row, () => jump(a.branch, nearest(a.branch, a.value))) : row;
  });
}
if (data.attractors.length) attractors();
