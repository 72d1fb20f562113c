// the ball of rolling.py on its canvas: seen obliquely from above, without perspective, by a camera that goes along
(() => {
  const figure = document.currentScript.closest("figure");
  const canvas = figure.querySelector("canvas"), button = figure.querySelector("button");
  const { step, place, attitude } = JSON.parse(figure.querySelector("[type='application/json']").textContent);
  const pen = canvas.getContext("2d");
  const SPEED = 1.6, TILT = 0.6, STILL = 24; // time units a second; radians above the plane; the time of the still
  const COLOURS = ["#0072B2", "#D55E00", "#009E73"];
  const [SIN, COS] = [Math.sin(TILT), Math.cos(TILT)];
  const last = (place.length - 1) * step;
  const middle = place.reduce((sum, p) => sum + p[1], 0) / place.length;
  let time = STILL, before = null, playing = false, seen = true, waiting = false;

  const mix = (rows, t) => {
    const k = Math.min(Math.floor(t / step), rows.length - 2), part = t / step - k;
    return rows[k].map((x, i) => x + part * (rows[k + 1][i] - x));
  };
  const matrix = (q) => { // of a quaternion that need not be a unit
    const n = q.reduce((sum, x) => sum + x * x, 0), [w, x, y, z] = q;
    return [
      [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
      [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ].map((row) => row.map((entry) => entry / n));
  };

  function draw() {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const look = getComputedStyle(canvas), dark = document.documentElement.dataset.theme === "dark";
    const ink = look.color, line = dark ? "#56B4E9" : COLOURS[0];
    const radius = Math.min(height / 4.6, width / 7), here = mix(place, time);
    const left = here[0] - (width / radius) * 0.08;
    // the point (x, y, z) of space on the canvas
    const at = ([x, y, z]) => [
      width / 2 + radius * (x - left),
      height * 0.6 - radius * ((y - middle) * SIN + z * COS),
    ];
    const path = (points) => {
      pen.beginPath();
      points.forEach((p, k) => (k ? pen.lineTo(...at(p)) : pen.moveTo(...at(p))));
    };
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = pen.lineCap = "round";

    // the plane, in squares of one radius
    pen.strokeStyle = ink;
    pen.globalAlpha = 0.13;
    pen.lineWidth = 1;
    const reach = width / radius / 2 + 1, near = middle - 3, far = middle + 3;
    for (let x = Math.ceil(left - reach); x < left + reach; x++) { path([[x, near, 0], [x, far, 0]]); pen.stroke(); }
    for (let y = Math.ceil(near); y <= far; y++) { path([[left - reach, y, 0], [left + reach, y, 0]]); pen.stroke(); }
    pen.globalAlpha = 1;

    // where it has touched the plane
    const trace = place.slice(0, Math.floor(time / step) + 1);
    path([...trace, here].map(([x, y]) => [x, y, 0]));
    pen.strokeStyle = line;
    pen.lineWidth = 2.5;
    pen.stroke();

    // shadow and ball
    const [cx, cy] = at([here[0], here[1], 1]), [sx, sy] = at([here[0], here[1], 0]);
    pen.beginPath();
    pen.ellipse(sx, sy, radius * 0.8, radius * 0.8 * SIN, 0, 0, 2 * Math.PI);
    pen.fillStyle = dark ? "rgba(0, 0, 0, .55)" : "rgba(0, 0, 0, .16)";
    pen.fill();
    const shade = pen.createRadialGradient(cx - radius * 0.35, cy - radius * 0.45, radius * 0.1, cx, cy, radius);
    for (const [part, colour] of [[0, "#ffffff"], [0.6, "#e3e8ee"], [1, "#aab4c0"]]) shade.addColorStop(part, colour);
    pen.beginPath();
    pen.arc(cx, cy, radius, 0, 2 * Math.PI);
    pen.fillStyle = shade;
    pen.fill();

    // its three circles and the ends of its axes, where they face the camera
    const turn = matrix(mix(attitude, time));
    const inSpace = (v) => turn.map((row) => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    const facing = ([, y, z]) => z * SIN - y * COS;
    const onBall = ([x, y, z]) => [here[0] + x, here[1] + y, 1 + z];
    COLOURS.forEach((colour, axis) => {
      pen.strokeStyle = colour;
      pen.lineWidth = Math.max(2, radius / 22);
      pen.beginPath();
      let drawn = false;
      for (let k = 0; k <= 96; k++) {
        const angle = (2 * Math.PI * k) / 96, v = [0, 0, 0];
        v[(axis + 1) % 3] = Math.cos(angle);
        v[(axis + 2) % 3] = Math.sin(angle);
        const p = inSpace(v), front = facing(p) > 0;
        if (front) pen[drawn ? "lineTo" : "moveTo"](...at(onBall(p)));
        drawn = front;
      }
      pen.stroke();
    });
    COLOURS.forEach((colour, axis) => {
      pen.fillStyle = colour;
      for (const sign of [1, -1]) {
        const v = [0, 0, 0];
        v[axis] = sign;
        const p = inSpace(v);
        if (facing(p) < 0.05) continue;
        pen.beginPath();
        pen.arc(...at(onBall(p)), radius / 11, 0, 2 * Math.PI);
        pen.fill();
      }
    });
    pen.fillStyle = ink;
    pen.font = `15px ${look.fontFamily}`;
    pen.fillText(`t = ${time.toFixed(1)}`, 12, 24);
  }

  function frame(now) {
    waiting = false;
    if (!playing || !seen) { before = null; return; }
    if (before !== null) time = (time + Math.min((now - before) / 1000, 0.1) * SPEED) % last;
    before = now;
    draw();
    next();
  }
  function next() {
    if (!waiting && playing && seen) { waiting = true; requestAnimationFrame(frame); }
  }
  function play(wanted) {
    playing = wanted;
    button.textContent = playing ? "Pause" : "Play";
    next();
  }

  button.addEventListener("click", () => play(!playing));
  new ResizeObserver(draw).observe(canvas);
  new MutationObserver(draw).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  new IntersectionObserver(([entry]) => { seen = entry.isIntersecting; next(); }).observe(canvas);
  draw();
  play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
