"use strict";
// Values are read by pointing, by touch or with the arrow keys; without this script the robot and
// the grid have tooltips, and the files come compressed.
for (const figure of document.querySelectorAll("figure")) {
  const out = figure.querySelector("output");
  const plot = figure.querySelector(".plot");
  if (!out || !plot) continue;
  const marks = [...plot.querySelectorAll(".m")];
  let current = null;
  // Figures of many marks have their numbers alone in the page: the words are made here.
  const words = (mark) => {
    const { v } = mark.dataset;
    const svg = mark.ownerSVGElement;
    if (!svg.dataset.cell) {
      const kept = mark.classList.contains("big");
      return `number ${marks.indexOf(mark) + 1}: ${v}, ${kept ? "kept" : "counts as zero"}`;
    }
    const column = mark.getAttribute("x") / svg.dataset.cell;
    return `${mark.parentNode.dataset.of} takes up ${v} ${svg.dataset.of.split("\n")[column]}`;
  };
  const text = (mark) => {
    let title = mark.querySelector(":scope > title");
    if (!title && "v" in mark.dataset) {
      title = document.createElementNS("http://www.w3.org/2000/svg", "title");
      title.textContent = words(mark);
      mark.append(title);
    }
    return title ? title.textContent : mark.getAttribute("title") || "";
  };
  const show = (mark) => {
    if (!mark || mark === current) return;
    if (current) current.classList.remove("on");
    current = mark;
    current.classList.add("on");
    out.textContent = text(mark);
  };
  const under = (event) => show(event.target.closest(".m"));
  plot.addEventListener("pointerover", under);
  plot.addEventListener("click", under);
  const centre = (mark) => {
    const box = mark.getBoundingClientRect();
    return [box.left + box.width / 2, box.top + box.height / 2];
  };
  // The nearest mark on that side; sideways distance counts four times.
  const next = (dx, dy) => {
    const [x, y] = centre(current);
    let best = null;
    let least = Infinity;
    for (const mark of marks) {
      const [u, v] = centre(mark);
      const along = (u - x) * dx + (v - y) * dy;
      const across = Math.abs((u - x) * dy) + Math.abs((v - y) * dx);
      if (along > 0.5 && along + 4 * across < least) {
        least = along + 4 * across;
        best = mark;
      }
    }
    return best;
  };
  const sides = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  plot.addEventListener("keydown", (event) => {
    const side = sides[event.key];
    if (!side || !marks.length) return;
    event.preventDefault();
    show(current ? next(...side) : marks[0]);
    current.scrollIntoView({ block: "nearest", inline: "nearest" });
  });
}
for (const link of document.querySelectorAll("a[data-name]")) {
  if (typeof DecompressionStream === "undefined") continue;
  link.addEventListener("click", async (event) => {
    event.preventDefault();
    const packed = Uint8Array.from(atob(link.href.split(",")[1]), (c) => c.charCodeAt(0));
    const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const url = URL.createObjectURL(await new Response(plain).blob());
    const save = document.createElement("a");
    save.href = url;
    save.download = link.dataset.name;
    save.click();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
  });
}
