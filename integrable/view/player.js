// Draws the frames of the motion in #motion, and moves them by the slider or in time. Everything drawn is in the file.
"use strict";
(function () {
  const motion = JSON.parse(document.getElementById("motion").textContent);
  const count = motion.times.length, last = count - 1;
  // the colours of the page, which follow the light or dark theme of the reader; bodies and faint lines have their own
  const style = getComputedStyle(document.documentElement), named = (name) => style.getPropertyValue("--" + name).trim();
  const [BLUE, ORANGE, GREEN, INK, PAPER] = ["first", "second", "third", "ink", "paper"].map(named);
  const GREY = "#9a9a9a", dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const [BALL, SPHERE, FAINT, PALE] = dark ? ["#4a4438", "#242b33", "#3d4650", "#33566e"] : ["#f3efe6", "#f2f4f7", "#c9ced6", "#a9c8dd"];
  const config = { responsive: true, displayModeBar: false };
  const byId = (id) => document.getElementById(id);
  const column = (rows, k) => rows.map((row) => row[k]);
  const quiet = { hoverinfo: "skip", showlegend: false };
  const hidden = { visible: false };
  const clear = { paper_bgcolor: PAPER, plot_bgcolor: PAPER, font: { size: 12, color: INK } };
  const bare = { xaxis: hidden, yaxis: hidden, zaxis: hidden, dragmode: "orbit" };
  const flat = { ...clear, margin: { l: 48, r: 12, t: 8, b: 40 }, showlegend: false, dragmode: false };
  const updates = [];

  // --- shapes

  function sphereMesh(radius, height, colour, opacity) {
    const x = [], y = [], z = [], i = [], j = [], k = [], round = 32, high = 16;
    for (let a = 0; a <= high; a++) for (let b = 0; b < round; b++) {
      const polar = (Math.PI * a) / high, turn = (2 * Math.PI * b) / round;
      x.push(radius * Math.sin(polar) * Math.cos(turn));
      y.push(radius * Math.sin(polar) * Math.sin(turn));
      z.push(height + radius * Math.cos(polar));
      if (a < high) {
        const here = a * round + b, next = a * round + ((b + 1) % round);
        i.push(here, next); j.push(next, next + round); k.push(here + round, here + round);
      }
    }
    const lighting = { ambient: 0.95, diffuse: 0.15, specular: 0.05 };
    return { type: "mesh3d", x, y, z, i, j, k, color: colour, opacity, lighting, ...quiet };
  }

  function circle(axis, radius) {
    const points = [];
    for (let n = 0; n <= 64; n++) {
      const at = (2 * Math.PI * n) / 64, point = [0, 0, 0];
      point[(axis + 1) % 3] = radius * Math.cos(at);
      point[(axis + 2) % 3] = radius * Math.sin(at);
      points.push(point);
    }
    return points;
  }

  function line3(points, colour, width, more) {
    return { type: "scatter3d", mode: "lines", x: column(points, 0), y: column(points, 1), z: column(points, 2),
             line: { color: colour, width }, ...quiet, ...more };
  }

  function dots3(points, colour, size) {
    return { type: "scatter3d", mode: "markers", x: column(points, 0), y: column(points, 1), z: column(points, 2),
             marker: { color: colour, size }, ...quiet };
  }

  const three = (points) => ({ x: column(points, 0), y: column(points, 1), z: column(points, 2) });

  function restyle(id, changes) { // [[trace, {x, y, z}], …]
    const update = { x: changes.map((c) => c[1].x), y: changes.map((c) => c[1].y) };
    if (changes[0][1].z) update.z = changes.map((c) => c[1].z);
    Plotly.restyle(id, update, changes.map((c) => c[0]));
  }

  function show(id, there) { if (!there) byId("figure-" + id).hidden = true; return there; }

  // --- the body, and the ball on its plane

  if (show("ball", motion.turning)) {
    const rolls = Boolean(motion.contact), reach = 5, height = rolls ? 1 : 0;
    const colours = [BLUE, ORANGE, GREEN], circles = [0, 1, 2].map((axis) => circle(axis, 1.01));
    const turned = (frame, point) => {
      const t = motion.turning[frame];
      return [t[0] * point[0] + t[1] * point[1] + t[2] * point[2], t[3] * point[0] + t[4] * point[1] + t[5] * point[2],
              height + t[6] * point[0] + t[7] * point[1] + t[8] * point[2]];
    };
    const ends = [[1.02, 0, 0], [0, 1.02, 0], [0, 0, 1.02]];
    const grid = (frame) => {
      const [cx, cy] = motion.contact[frame], points = [], gap = 1;
      for (let n = -reach; n <= reach; n++) {
        const x = n * gap - (((cx % gap) + gap) % gap), y = n * gap - (((cy % gap) + gap) % gap);
        points.push([x, -reach, 0], [x, reach, 0], [null, null, null]);
        points.push([-reach, y, 0], [reach, y, 0], [null, null, null]);
      }
      return points;
    };
    const trail = (frame) => {
      const [cx, cy] = motion.contact[frame], points = [];
      for (let n = frame; n >= 0; n--) {
        const x = motion.contact[n][0] - cx, y = motion.contact[n][1] - cy;
        if (Math.abs(x) > reach || Math.abs(y) > reach) break;
        points.push([x, y, 0.01]);
      }
      return points;
    };
    const traces = [sphereMesh(0.99, height, BALL, 1)];
    circles.forEach((points, axis) => traces.push(line3(points.map((p) => turned(0, p)), colours[axis], 7)));
    ends.forEach((end, axis) => traces.push(dots3([turned(0, end)], colours[axis], 7)));
    if (rolls) {
      traces.push(line3(grid(0), FAINT, 1.5), line3(trail(0), INK, 5));
    }
    const span = rolls ? reach : 1.25;
    const scene = { ...bare, aspectmode: "manual", aspectratio: rolls ? { x: 2, y: 2, z: 0.5 } : { x: 1, y: 1, z: 1 },
                    camera: { eye: rolls ? { x: 1.35, y: -0.75, z: 0.8 } : { x: 1.2, y: -0.9, z: 0.6 } } };
    scene.xaxis = { visible: false, range: [-span, span] };
    scene.yaxis = { visible: false, range: [-span, span] };
    scene.zaxis = { visible: false, range: rolls ? [-0.05, 2.45] : [-span, span] };
    Plotly.newPlot("ball", traces, { ...clear, scene, margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false }, config);
    updates.push((frame) => {
      const changes = circles.map((points, axis) => [1 + axis, three(points.map((p) => turned(frame, p)))]);
      ends.forEach((end, axis) => changes.push([4 + axis, three([turned(frame, end)])]));
      if (rolls) changes.push([7, three(grid(frame))], [8, three(trail(frame))]);
      restyle("ball", changes);
    });
  }

  if (show("path", motion.contact)) {
    const x = column(motion.contact, 0), y = column(motion.contact, 1);
    const layout = { ...flat, xaxis: { title: { text: "y, radii" }, gridcolor: FAINT, zeroline: false, automargin: true },
                     yaxis: { title: { text: "x, radii" }, gridcolor: FAINT, zeroline: false, automargin: true } };
    // the long way of the path lies along y: that is drawn to the right
    const wide = Math.max(...y) - Math.min(...y), high = Math.max(...x) - Math.min(...x);
    if (wide < 8 * high) layout.yaxis.scaleanchor = "x";
    Plotly.newPlot("path", [
      { x: y, y: x, mode: "lines", line: { color: GREY, width: 1 }, ...quiet },
      { x: [y[0]], y: [x[0]], mode: "markers", marker: { color: ORANGE, size: 10 }, ...quiet },
    ], layout, config);
    updates.push((frame) => restyle("path", [[1, { x: [y[frame]], y: [x[frame]] }]]));
  }

  // --- γ

  {
    const lifted = motion.gamma.map((row) => row.map((value) => 1.012 * value));
    const names = ["γ₁", "γ₂", "γ₃"], ends = [[1.2, 0, 0], [0, 1.2, 0], [0, 0, 1.2]];
    const way = motion.steps ? (rows, colour) => dots3(rows, colour, 2.5) : (rows, colour, width) => line3(rows, colour, width);
    const traces = [sphereMesh(1, 0, SPHERE, 1)];
    [0, 1, 2].forEach((axis) => traces.push(line3(circle(axis, 1.004), FAINT, 2)));
    traces.push({ type: "scatter3d", mode: "text", text: names, ...three(ends), textfont: { size: 14, color: INK }, ...quiet });
    traces.push(way(lifted, PALE, 2), way(lifted.slice(0, 1), BLUE, 5), dots3([lifted[0]], ORANGE, 7));
    const box = { visible: false, range: [-1.25, 1.25] };
    const g = motion.gamma[0], eye = { x: 1.05 * g[0] + 0.5, y: 1.05 * g[1] + 0.4, z: 1.05 * g[2] + 0.45 };
    const size = 1.55 / Math.hypot(eye.x, eye.y, eye.z);
    Object.keys(eye).forEach((key) => { eye[key] *= size; });
    Plotly.newPlot("sphere", traces, {
      scene: { ...bare, xaxis: box, yaxis: box, zaxis: box, aspectmode: "cube", camera: { eye } },
      ...clear, margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false,
    }, config);
    updates.push((frame) =>
      restyle("sphere", [[6, three(lifted.slice(0, frame + 1))], [7, three([lifted[frame]])]]));
  }

  // --- the two points, and the torus

  if (show("ovals", motion.points)) {
    const traces = [];
    motion.ovals.forEach(([x, y], k) => {
      const where = k ? { xaxis: "x2", yaxis: "y2" } : {};
      traces.push({ x, y, mode: "lines", line: { color: GREY, width: 2 }, ...where, ...quiet });
    });
    motion.ovals.forEach((_, k) => {
      const where = k ? { xaxis: "x2", yaxis: "y2" } : {};
      const p = motion.points[0];
      traces.push({ x: [p[k]], y: [p[2 + k]], mode: "markers", marker: { color: k ? GREEN : ORANGE, size: 12 }, ...where, ...quiet });
    });
    const axis = { gridcolor: FAINT, zeroline: true, zerolinecolor: GREY, nticks: 4, automargin: true };
    Plotly.newPlot("ovals", traces, {
      ...flat,
      xaxis: { ...axis, domain: [0, 0.42], title: { text: "x" } }, yaxis: { ...axis, title: { text: "y", standoff: 2 } },
      xaxis2: { ...axis, domain: [0.64, 1], title: { text: "x" } },
      yaxis2: { ...axis, anchor: "x2", ticklabelposition: "outside", ticks: "outside" },
    }, config);
    updates.push((frame) => {
      const p = motion.points[frame];
      restyle("ovals", [[2, { x: [p[0]], y: [p[2]] }], [3, { x: [p[1]], y: [p[3]] }]]);
    });
  }

  if (show("torus", motion.angles)) {
    // a line that leaves the square on one side enters on the other: both pieces are drawn up to the edge
    const folded = (value, upper) => {
      const whole = Math.round(value);
      return Math.abs(value - whole) < 1e-9 ? (upper ? 1 : 0) : value - Math.floor(value);
    };
    const broken = (upTo) => {
      let at = motion.angles[0];
      const x = [at[0]], y = [at[1]];
      for (let n = 1; n <= upTo; n++) {
        const next = motion.angles[n], way = [0, 1].map((k) => next[k] - at[k] - Math.round(next[k] - at[k]));
        const crossings = [0, 1].map((k) => (at[k] + way[k] > 1 ? (1 - at[k]) / way[k] : at[k] + way[k] < 0 ? -at[k] / way[k] : 2));
        if (motion.steps) { x.push(null); y.push(null); }
        else for (const part of crossings.filter((part) => part <= 1).sort()) {
          const [a, b] = [0, 1].map((k) => at[k] + part * way[k]);
          x.push(folded(a, way[0] > 0), null, folded(a, way[0] < 0));
          y.push(folded(b, way[1] > 0), null, folded(b, way[1] < 0));
        }
        x.push(next[0]); y.push(next[1]);
        at = next;
      }
      return { x, y };
    };
    const mode = motion.steps ? "markers" : "lines";
    const look = (colour, width) => (motion.steps ? { marker: { color: colour, size: width + 2 } } : { line: { color: colour, width } });
    const axis = { gridcolor: FAINT, range: [0, 1], zeroline: false, nticks: 5, constrain: "domain" };
    Plotly.newPlot("torus", [
      { ...broken(last), mode, ...look(PALE, 1), ...quiet },
      { ...broken(0), mode, ...look(BLUE, 2), ...quiet },
      { x: [motion.angles[0][0]], y: [motion.angles[0][1]], mode: "markers", marker: { color: ORANGE, size: 12 }, ...quiet },
    ], { ...flat, xaxis: { ...axis, title: { text: "first angle, turns" } },
         yaxis: { ...axis, title: { text: "second angle, turns" }, scaleanchor: "x" } }, config);
    updates.push((frame) => {
      const [a, b] = motion.angles[frame];
      restyle("torus", [[1, broken(frame)], [2, { x: [a], y: [b] }]]);
    });
  }

  // --- time

  const slider = byId("slider"), play = byId("play"), time = byId("time");
  slider.max = last;
  const label = (value) => (value === 0 ? "0" : Math.abs(value) >= 1e5 || Math.abs(value) < 1e-2 ? value.toExponential(2) : value.toPrecision(4));
  let drawn = -1;
  function draw(frame) {
    if (frame === drawn) return;
    drawn = frame;
    updates.forEach((update) => update(frame));
    const words = motion.steps ? `step ${motion.times[frame]} of ${motion.times[last]}`
      : `t = ${label(motion.times[frame])} of ${label(motion.times[last])}`;
    time.textContent = words;
    slider.setAttribute("aria-valuetext", words);
  }
  slider.addEventListener("input", () => draw(Number(slider.value)));
  const SECONDS = 40; // for the whole of it, at speed 1
  const speed = byId("speed"), loop = byId("loop");
  let started = null, from = 0;
  function tick(now) {
    if (started === null) return;
    const ahead = Math.round(((now - started) / 1000 / SECONDS) * Number(speed.value) * last);
    const frame = loop.checked ? (from + ahead) % count : Math.min(last, from + ahead);
    slider.value = frame;
    draw(frame);
    if (frame === last && !loop.checked) stop(); else requestAnimationFrame(tick);
  }
  function stop() { started = null; play.textContent = "Play"; }
  function start() {
    from = Number(slider.value) === last ? 0 : Number(slider.value);
    play.textContent = "Pause";
    started = performance.now();
    requestAnimationFrame(tick);
  }
  play.addEventListener("click", () => { if (started !== null) stop(); else start(); });
  // another speed goes on from where the slider is
  speed.addEventListener("change", () => { if (started !== null) { from = Number(slider.value); started = performance.now(); } });

  // --- a picture or a video of the first panel

  const main = ["ball", "sphere"].find((id) => !byId("figure-" + id).hidden);
  const size = { format: "png", width: 960, height: 720 };
  function save(url, name) {
    const link = document.createElement("a");
    link.href = url;
    link.download = name;
    link.click();
  }
  byId("picture").addEventListener("click", async () => save(await Plotly.toImage(main, size), `${motion.name}.png`));

  const video = byId("video"), kinds = ["video/mp4", "video/webm"];
  const kind = window.MediaRecorder && kinds.find((type) => MediaRecorder.isTypeSupported(type));
  video.hidden = !kind;
  // frames are drawn one by one and shown for as long as they take: the video is as fast as this browser draws
  video.addEventListener("click", async () => {
    stop();
    video.disabled = true;
    const canvas = Object.assign(document.createElement("canvas"), { width: size.width, height: size.height });
    const context = canvas.getContext("2d"), stream = canvas.captureStream(), chunks = [];
    const recorder = new MediaRecorder(stream, { mimeType: kind, videoBitsPerSecond: 8e6 });
    recorder.ondataavailable = (event) => chunks.push(event.data);
    const done = new Promise((resolve) => { recorder.onstop = resolve; });
    context.fillStyle = PAPER;
    const each = Math.max(1, Math.round(count / 200));
    recorder.start();
    for (let frame = 0; frame < count; frame += each) {
      slider.value = frame;
      draw(frame);
      const image = new Image();
      image.src = await Plotly.toImage(main, size);
      await image.decode();
      context.fillRect(0, 0, size.width, size.height);
      context.drawImage(image, 0, 0);
      video.textContent = `${Math.round((100 * frame) / count)} %`;
    }
    recorder.stop();
    await done;
    save(URL.createObjectURL(new Blob(chunks, { type: kind })), `${motion.name}.${kind.slice(6)}`);
    video.textContent = "Video";
    video.disabled = false;
  });

  draw(0);
  window.drawFrame = draw;
})();
