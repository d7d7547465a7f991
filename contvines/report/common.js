// What every page has: its data, plotly, colours, numbers as text, tables, buttons that copy.
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
const number = (v, digits = 10) => (v === null || v === undefined ? "" : Math.abs(v) < 1e-15 ? "0" : String(Number(v.toPrecision(digits))));
const many = (list, one, more) => `${list.length} ${list.length === 1 ? one : more}`;
const element = (tag, text, attributes = {}) => {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
};
const ink = () => getComputedStyle(document.body).color;
const layout = (more) => ({
  paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink(), size: 13 }, hovermode: "closest",
  margin: { l: 62, r: 12, t: 12, b: 46 }, showlegend: false, modebar: { bgcolor: "rgba(0,0,0,0)", color: "#a0a0a0", activecolor: ink() },
  ...more,
});
// a title longer than a narrow screen goes on in a second line
const lines = (text) => (innerWidth > 600 ? text : text.split(" ").reduce((made, word) => (made.length - made.lastIndexOf(">") + word.length > 36 ? `${made}<br>${word}` : `${made} ${word}`).trim(), ""));
const axis = (title, more = {}) => ({ title: { text: lines(title) }, automargin: true, gridcolor: dark.matches ? "#3a3d44" : "#e6e6e6", zeroline: false, ...more });
const options = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d"] };
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

/* paper is narrower than the screen: pictures are laid out again for it, and afterwards for the screen */
const PAPER = 690; // pixels between the margins of a sheet
const pictures = () => [...document.querySelectorAll(".js-plotly-plot")].filter((picture) => picture.offsetParent !== null);
addEventListener("beforeprint", () => pictures().forEach((picture) => {
  const share = picture.id === "portrait" ? 0.42 : picture.id === "history" ? 0.56 : 1;
  Plotly.relayout(picture, { autosize: false, width: PAPER * share, height: picture.id === "diagram" ? 420 : picture.offsetHeight });
}));
addEventListener("afterprint", () => pictures().forEach((picture) => Plotly.relayout(picture, { autosize: true, width: null, height: null })));
let clock = null;
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

// ------------------------------------------------------------------ buttons
document.querySelectorAll("[data-copy]").forEach((button) => button.addEventListener("click", async () => {
  const text = $(button.dataset.copy).textContent;
  try { await navigator.clipboard.writeText(text); } catch { const range = document.createRange(); range.selectNodeContents($(button.dataset.copy)); getSelection().removeAllRanges(); getSelection().addRange(range); }
  button.textContent = "copied";
  setTimeout(() => { button.textContent = "copy"; }, 1200);
}));

// how it was made: rows of name and value
function made(rows) {
  table("made", null, [["file", data.source], ["contvines", data.version], ...rows], ([k, v]) => cells(element("tr"), [k, String(v)]));
}
const settled = (entries, word) => Object.entries(entries).map(([k, v]) => [`${word}: ${k}`, v]);
