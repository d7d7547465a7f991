"use strict";
(async () => {
  const $ = (id) => document.getElementById(id);
  const unpack = async (id) => {
    const bytes = Uint8Array.from(atob($(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };
  const data = JSON.parse(await unpack("data"));
  const program = document.createElement("script");
  program.textContent = await unpack("plotly");
  document.head.append(program);

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const colors = ["#0b3c6f", "#d9484b", "#4b1a66", "#2a9147", "#7a1f0d", "#b8761f", "#005a5a", "#c2559d"];
  const light = ["#6fb1ff", "#ff8285", "#c79be6", "#69d68a", "#e08a6f", "#f0b860", "#5fc9c9", "#f29bd4"];
  const shapes = { s: "square", D: "diamond-open", o: "circle-open", "^": "triangle-up-open", p: "pentagon-open", h: "hexagon-open",
    v: "triangle-down", ">": "triangle-right", "<": "triangle-left", X: "x", "*": "star", "|": "line-ns-open" };
  const branches = Object.fromEntries(data.branches.map((b) => [b.label, b]));
  const points = Object.fromEntries(data.special.map((p) => [p.label, p]));
  const number = (v, digits = 10) => (v === null || v === undefined ? "" : Math.abs(v) < 1e-15 ? "0" : String(Number(v.toPrecision(digits))));
  const element = (tag, text, attributes = {}) => {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    return made;
  };
  const ink = () => getComputedStyle(document.body).color;
  const layout = (more) => ({
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink(), size: 13 }, hovermode: "closest",
    margin: { l: 62, r: 12, t: 12, b: 46 }, showlegend: false,
    ...more,
  });
  const axis = (title, more = {}) => ({ title: { text: title }, gridcolor: dark.matches ? "#3a3d44" : "#e6e6e6", zeroline: false, ...more });
  const options = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d"] };
  let here = null; // { branch, index, label }
  let clock = null;

  // ------------------------------------------------------------------ the diagram
  function traces() {
    const x = $("x").value, y = $("y").value, found = [];
    data.branches.forEach((branch, k) => {
      if (!branch.real && !$("virtual").checked) return;
      const xs = branch.measures[x], ys = branch.measures[y];
      if (!xs || !ys) return;
      const color = (dark.matches ? light : colors)[k % colors.length];
      const about = xs.map((_, i) => `<b>${branch.label}</b> ${branch.what}<br>${x} = ${number(xs[i], 8)}<br>${y} = ${number(ys[i], 8)}<br>` +
        `${branch.real ? (branch.stable_points[i] ? "stable" : "unstable") : "virtual"}, point ${i}`);
      for (let first = 0; first < xs.length; ) {
        let last = first;
        const state = (i) => branch.stable_points[i] && branch.stable_points[i + 1];
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

  /* labels that would cover one another at this zoom are left out; the hover names every mark */
  function thin() {
    const picture = $("diagram"), full = picture._fullLayout;
    const k = picture.data.findIndex((t) => t.mode === "markers+text");
    if (k < 0 || !full.xaxis) return;
    const names = picture.data[k].customdata.map((c) => c[2]), kept = [];
    const text = names.map((name, i) => {
      const x = full.xaxis.d2p(picture.data[k].x[i]), y = full.yaxis.d2p(picture.data[k].y[i]), w = 4 + 4 * name.length;
      const inside = x >= 0 && y >= 0 && x <= full.xaxis._length && y <= full.yaxis._length;
      if (!inside || kept.some(([a, b, v]) => Math.abs(a - x) < w + v && Math.abs(b - y) < 15)) return "";
      kept.push([x, y, w]);
      return name;
    });
    if (JSON.stringify(text) !== JSON.stringify(picture.data[k].text)) Plotly.restyle(picture, { text: [text] }, [k]);
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
    facts.push(about.real ? (about.stable_points[index] ? "stable" : "unstable") : "virtual: no machine can follow it");
    if (shown.length) facts.push(`multipliers ${shown.join(", ")}`);
    else if (sizes.length) facts.push("multipliers not defined at a graze");
    if (about.margin[index] !== null) facts.push(`smallest margin ${number(about.margin[index], 6)}`);
    if (special && special.criticality) facts.push(special.criticality);
    if (special && special.proof) facts.push(special.proof);
    if (special && special.note) facts.push(special.note);
    $("orbit-about").textContent = facts.join("; ");
    $("orbit-about").classList.toggle("virtual", !about.real);
    const name = special ? label : `${branch}:${index}`;
    $("command").textContent = `contvines orbit ${data.source} ${name}`;
    $("python").textContent = special ? `cv.load("${data.source}")["${label}"].orbit` : `cv.load("${data.source}")["${branch}"].orbit(${index})`;
    document.querySelectorAll("tr.chosen").forEach((row) => row.classList.remove("chosen"));
    for (const id of [`row-${label}`, `row-${branch}`]) if ($(id)) $(id).classList.add("chosen");
    const place = nearest(branch, index);
    const scene = place === null ? null : data.orbits[branch][place];
    for (const id of ["portrait", "history", "stage"]) $(id).hidden = !scene;
    if (scene) show(scene);
    else stop();
    draw();
  }
  function show(scene) {
    const tint = dark.matches ? "#6fb1ff" : "#0b3c6f", second = dark.matches ? "#ff9d5c" : "#b5531c", grey = "#8a8a8a";
    const { portrait, history, events } = scene;
    const walls = (portrait.walls || []).map((w) => ({ type: "line", x0: w, x1: w, yref: "paper", y0: 0, y1: 1, line: { color: grey, width: 5 } }));
    Plotly.react("portrait", [
      { x: portrait.x, y: portrait.y, mode: "lines", line: { color: tint, width: 1.8 }, hoverinfo: "skip" },
      { x: events.map((e) => e.x), y: events.map((e) => e.y), mode: "markers+text", text: events.map((e) => e.event), textposition: "top center",
        marker: { size: 8, color: tint, symbol: "circle-open" }, hoverinfo: "text" },
    ], layout({ shapes: walls, xaxis: axis(portrait.names[0], portrait.reversed ? { autorange: "reversed" } : {}), yaxis: axis(portrait.names[1]) }), options);
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
  function animate(motion) {
    stop();
    const canvas = $("animation"), pen = canvas.getContext("2d");
    const all = [...motion.box.map((v) => v + motion.half_width), ...motion.box.map((v) => v - motion.half_width)];
    const low = Math.min(...all), high = Math.max(...all), sign = motion.left > 0 ? -1 : 1; // the left wall stands on the left
    const at = (v) => canvas.width / 2 + sign * (v - (low + high) / 2) * (canvas.width - 90) / (high - low);
    const paint = (share) => {
      const n = motion.box.length, t = share * (n - 1), i = Math.min(Math.floor(t), n - 2), f = t - i;
      const mix = (v) => v[i] * (1 - f) + v[i + 1] * f;
      const box = mix(motion.box), body = mix(motion.body), width = 34;
      pen.clearRect(0, 0, canvas.width, canvas.height);
      pen.strokeStyle = ink(); pen.lineWidth = 3;
      const [a, b] = [at(box + motion.half_width), at(box - motion.half_width)].sort((p, q) => p - q);
      pen.beginPath();
      pen.moveTo(a - width / 2, 18); pen.lineTo(a - width / 2, 88); pen.lineTo(b + width / 2, 88); pen.lineTo(b + width / 2, 18);
      pen.stroke();
      pen.fillStyle = dark.matches ? "#ff9d5c" : "#b5531c";
      pen.fillRect(at(body) - width / 2, 52, width, 34);
      frame += 1;
      canvas.dataset.frame = frame;
    };
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
  let started = false;

  // ------------------------------------------------------------------ tables
  function table(id, head, rows, row) {
    $(id).tHead?.append(element("tr"));
    if (head) head.forEach((text) => $(id).tHead.rows[0].append(element("th", text, { scope: "col" })));
    for (const entry of rows) $(id).tBodies[0].append(row(entry));
  }
  function clickable(row, act) {
    row.tabIndex = 0;
    row.addEventListener("click", act);
    row.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); act(); } });
    return row;
  }
  const cells = (row, texts) => { texts.forEach((text) => row.append(element("td", text))); return row; };
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
  table("branches", ["branch", "what", data.parameter, "stable", "points"], data.branches, (b) => {
    const row = cells(element("tr", undefined, { id: `row-${b.label}` }), [b.label,
      [b.what, b.periods === null ? "" : `k=${b.periods}`, b.symmetric ? "symmetric" : "", b.real ? "" : "virtual"].filter(Boolean).join(" "),
      `${number(b.range[0], 7)} … ${number(b.range[1], 7)}`, b.stable.map(([a, z]) => `${number(a, 7)} … ${number(z, 7)}`).join(", ") || "–", String(b.points)]);
    if (!b.real) row.className = "virtual";
    return clickable(row, () => jump(b.label, Math.floor(b.points / 2)));
  });
  table("made", null, [["file", data.source], ["contvines", data.version],
    ...Object.entries(data.model).map(([k, v]) => [`model: ${k}`, String(v)]),
    [`${data.parameter} within`, data.within.map((v) => number(v)).join(" to ")],
    ...Object.entries(data.settings).map(([k, v]) => [`setting: ${k}`, String(v)]), ["run", data.finished ? data.message : "unfinished"]],
  ([k, v]) => cells(element("tr"), [k, v]));

  // ------------------------------------------------------------------ the page
  $("title").textContent = `${data.model.name || "problem"}: motions over ${data.names[data.parameter]}`;
  $("about").textContent = `${data.branches.length} branches, ${data.special.length} special points` + (data.finished ? "" : ", unfinished") +
    "; solid lines are stable, dashed unstable, dotted virtual (beyond a border).";
  for (const id of ["x", "y"]) {
    for (const [name, text] of Object.entries(data.names)) $(id).append(element("option", text, { value: name }));
    $(id).value = data.axes[id];
    $(id).addEventListener("change", () => draw(false));
  }
  $("virtual").closest("label").hidden = data.branches.every((b) => b.real);
  $("virtual").addEventListener("change", () => draw());
  $("reset").addEventListener("click", () => draw(false));
  document.querySelectorAll("[data-copy]").forEach((button) => button.addEventListener("click", async () => {
    const text = $(button.dataset.copy).textContent;
    try { await navigator.clipboard.writeText(text); } catch { const range = document.createRange(); range.selectNodeContents($(button.dataset.copy)); getSelection().removeAllRanges(); getSelection().addRange(range); }
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy"; }, 1200);
  }));
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
  document.body.dataset.ready = "yes";
})();
