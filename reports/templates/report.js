"use strict";
(() => {
  const figures = JSON.parse(document.getElementById("figure-data").textContent);
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const config = {
    responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d"],
    showSendToCloud: false, plotlyServerURL: "", // measured data stays where the file is
  };

  // The page knows the colours, so that they follow its light or dark surface.
  const tone = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

  const axis = (given) => Object.assign({
    automargin: true, gridcolor: tone("grid"), linecolor: tone("quiet"), zeroline: false, showline: true,
    ticks: "outside", ticklen: 4, tickcolor: tone("quiet"), separatethousands: true, exponentformat: "power",
  }, given, { title: { text: given.title.text, standoff: 8 } });

  const coloured = (figure, size) => {
    const ink = tone("ink");
    const data = figure.data.map((trace) =>
      ({ ...trace, line: { ...trace.line, color: tone("series-" + trace.meta) },
        ...(trace.fill && { fillcolor: tone("series-" + trace.meta) + "40" }),
        ...(trace.marker && { marker: { ...trace.marker, color: tone("series-" + trace.meta) } }) }));
    const shapes = figure.layout.shapes.map(({ name, ...shape }) => name === "band"
      ? { ...shape, fillcolor: tone("band") }
      : { ...shape, line: { ...shape.line, color: tone(name) } });
    const annotations = figure.layout.annotations.map(({ name, ...note }) =>
      ({ ...note, font: { ...note.font, color: tone(name) }, bgcolor: tone(name === "quiet" ? "band" : "page") + "d9", borderpad: 1 }));
    const layout = {
      ...figure.layout, ...size, shapes, annotations,
      autosize: !size, xaxis: axis(figure.layout.xaxis), yaxis: axis(figure.layout.yaxis),
      font: { family: "-apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', 'Noto Sans', 'Liberation Sans', sans-serif", size: size ? 9 : 12, color: ink },
      paper_bgcolor: tone("page"), plot_bgcolor: tone("page"), hovermode: "x unified",
      hoverlabel: { bgcolor: tone("panel"), bordercolor: tone("rule"), font: { color: ink }, namelength: -1 },
      legend: { orientation: "h", x: 0, xanchor: "left", y: 1.02, yanchor: "bottom", entrywidthmode: "pixels", bgcolor: "rgba(0,0,0,0)" },
      margin: { l: 56, r: size ? 12 : 40, t: 8, b: 44 },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: tone("quiet"), activecolor: tone("link"), orientation: "v" },
    };
    return [data, layout];
  };

  const draw = (id, size) => Plotly.react(id, ...coloured(figures[id], size), config);

  // Envelopes of curves that cover each other; the curves themselves once one has zoomed in.
  const watch = (id) => {
    const { covering } = figures[id];
    if (!covering) return;
    let curves = false;
    const place = document.getElementById(id);
    place.on("plotly_relayout", () => {
      const [from, to] = place.layout.xaxis.range;
      if ((to - from < covering.curves_below) === curves) return;
      curves = !curves;
      Plotly.restyle(id, { visible: curves }, covering.curves);
      Plotly.restyle(id, { visible: !curves }, covering.envelopes);
    });
  };
  const ids = Object.keys(figures);

  // Figures near the screen come first; the rest is drawn when it comes near.
  const drawn = new Set();
  const near = new IntersectionObserver((entries) => entries.filter((e) => e.isIntersecting).forEach((entry) => {
    near.unobserve(entry.target);
    drawn.add(entry.target.id);
    draw(entry.target.id).then(() => watch(entry.target.id));
  }), { rootMargin: "800px" });
  ids.forEach((id) => near.observe(document.getElementById(id)));

  dark.addEventListener("change", () => drawn.forEach((id) => draw(id)));

  // Paper: light surface, all figures, half a text line wide.
  const millimetre = 96 / 25.4;
  window.addEventListener("beforeprint", () => ids.forEach((id) => {
    const wide = document.getElementById(id).closest("figure").classList.contains("wide");
    draw(id, { width: (wide ? 180 : 87) * millimetre, height: 60 * millimetre });
  }));
  window.addEventListener("afterprint", () => ids.forEach((id) => { drawn.add(id); draw(id); }));
})();
