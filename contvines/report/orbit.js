// One motion: portrait, history, animation.
function show(scene) {
  const tint = dark.matches ? "#6fb1ff" : "#0b3c6f", second = dark.matches ? "#ff9d5c" : "#b5531c", grey = "#8a8a8a";
  const { portrait, history, events } = scene;
  const walls = (portrait.walls || []).map((w) => ({ type: "line", x0: w, x1: w, yref: "paper", y0: 0, y1: 1, layer: "below", line: { color: grey, width: 5 } }));
  // the letter of an impact stands inside, beside its wall
  const inner = (e) => {
    if (!(portrait.walls || []).some((w) => Math.abs(w - e.x) < 1e-6)) return "top center";
    const leftmost = portrait.x.every((x) => (portrait.reversed ? x <= e.x + 1e-6 : x >= e.x - 1e-6));
    return leftmost ? "middle right" : "middle left";
  };
  // at an event there are two points of one time: a gap, and a dotted jump from one to the other; the last event is at both ends
  const after = history.x.flatMap((time, i) => (i && time === history.x[i - 1] ? [i] : []));
  const flights = (v) => v.flatMap((value, i) => (after.includes(i) ? [null, value] : [value]));
  const jumps = (v) => [...after, 0].flatMap((i) => [v.at(i - 1), v[i], null]);
  Plotly.react("portrait", [
    { x: flights(portrait.x), y: flights(portrait.y), mode: "lines", line: { color: tint, width: 1.8 }, hoverinfo: "skip" },
    { x: jumps(portrait.x), y: jumps(portrait.y), mode: "lines", line: { color: tint, width: 1, dash: "dot" }, hoverinfo: "skip" },
    { x: events.map((e) => e.x), y: events.map((e) => e.y), mode: "markers+text", text: events.map((e) => e.event), textposition: events.map(inner),
      marker: { size: 8, color: tint, symbol: "circle-open" }, hoverinfo: "text" },
  ], layout({ shapes: walls, xaxis: axis(portrait.names[0], { showgrid: false, ...(portrait.reversed ? { autorange: "reversed" } : {}) }), yaxis: axis(portrait.names[1]) }), options);
  const curves = Object.entries(history.curves).map(([name, y], i) => ({ x: history.x, y, name, mode: "lines",
    line: { color: i % 2 ? second : grey, width: 1.8, dash: i % 2 ? "solid" : "dash" } }));
  const sides = (history.walls || []).map((y) => ({ x: history.x, y, mode: "lines", line: { color: grey, width: 1 }, hoverinfo: "skip", showlegend: false }));
  Plotly.react("history", [...sides, ...curves], layout({ showlegend: true, legend: { orientation: "h", y: 1.12 }, margin: { l: 52, r: 12, t: 30, b: 46 },
    xaxis: axis(history.name), yaxis: axis(history.unit) }), options);
  $("stage").hidden = !scene.animation;
  if (scene.animation) animate(scene.animation);
  else stop();
}

// ------------------------------------------------------------------ the animation
function stop() {
  if (clock !== null) cancelAnimationFrame(clock);
  clock = null;
  $("play").setAttribute("aria-pressed", "false");
  $("play").textContent = "play";
}
let frame = 0;
function stage(motion) {
  // an absorber in its cavity, or the bodies and walls of a machine on a page: what stands where, and how to draw it
  const canvas = $("animation"), pen = canvas.getContext("2d"), width = 34;
  const cavity = Boolean(motion.box);
  const tracks = cavity ? [] : Object.values(motion.bodies), walls = motion.walls;
  const all = cavity
    ? motion.walls.flatMap((wall) => motion.box.map((v) => v - wall))
    : [...tracks.flat(), ...walls.map((wall) => wall.at).flat()];
  const low = Math.min(...all), high = Math.max(...all), sign = motion.left > 0 ? -1 : 1; // the left wall stands on the left
  const at = (v) => canvas.width / 2 + sign * (v - (low + high) / 2) * (canvas.width - 90) / (high - low || 1);
  const n = cavity ? motion.box.length : tracks[0].length;
  const fill = dark.matches ? "#ff9d5c" : "#b5531c";
  const paint = (share) => {
    const t = share * (n - 1), i = Math.min(Math.floor(t), n - 2), f = t - i;
    const mix = (v) => v[i] * (1 - f) + v[i + 1] * f;
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.strokeStyle = ink(); pen.lineWidth = 3; pen.fillStyle = fill;
    pen.beginPath();
    if (cavity) {
      const box = mix(motion.box);
      const [a, b] = walls.map((wall) => at(box - wall)).sort((p, q) => p - q);
      pen.moveTo(a - width / 2, 18); pen.lineTo(a - width / 2, 88); pen.lineTo(b + width / 2, 88); pen.lineTo(b + width / 2, 18);
      pen.stroke();
      pen.fillRect(at(mix(motion.body)) - width / 2, 52, width, 34);
    } else {
      pen.moveTo(8, 88); pen.lineTo(canvas.width - 8, 88);
      for (const wall of walls) {
        const x = at(mix(wall.at)) + sign * wall.side * width / 2;
        pen.moveTo(x, 18); pen.lineTo(x, 88);
      }
      pen.stroke();
      tracks.forEach((body, k) => {
        const x = at(mix(body));
        pen.fillStyle = k % 2 ? (dark.matches ? "#6fb1ff" : "#0b3c6f") : fill;
        pen.fillRect(x - width / 2, 52, width, 34);
      });
    }
    frame += 1;
    canvas.dataset.frame = frame;
    canvas.dataset.body = at(mix(cavity ? motion.body : tracks[0])).toFixed(1);
  };
  canvas.setAttribute("aria-label", cavity ? "the absorber in its cavity" : `${Object.keys(motion.bodies).join(", ")} of the machine, its walls`);
  return paint;
}
function animate(motion) {
  stop();
  const paint = stage(motion);
  const seconds = 2.5 * (motion.periods || 1);
  const run = (start) => (now) => {
    paint(((now - start) / 1000 / seconds) % 1);
    clock = requestAnimationFrame(run(start));
  };
  paint(0);
  $("play").onclick = () => {
    if (clock !== null) return stop();
    $("play").setAttribute("aria-pressed", "true");
    $("play").textContent = "pause";
    clock = requestAnimationFrame((now) => run(now)(now));
  };
  if (!still.matches && started) $("play").onclick();
}
