/*
 * The camera: where it stands, in metres from the corner of the points' bounds, and where it looks.
 */
const add = (a, b, s = 1) => a.map((x, k) => x + s * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
	a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(...a);
const unit = (a) => a.map((x) => x / (norm(a) || 1));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

const STEEPEST = 1.55; /* radians from the horizon: straight up has no right and left */

const camera = {
	eye: [0, 0, 0], yaw: 0, pitch: 0, angle: 50,
	aspect: 0, /* width by height of the picture that it was chosen for; 0: any */
	near: 0, home: [0, 0, 0],
	pivot: [0, 0, 0], /* what is turned about */
	extent: norm(scene.side) || 1,

	/* Directions at yaw 0, right handed with up. */
	frame() {
		const up = scene.up, side = Math.abs(up[0]) > 0.9 ? [0, 1, 0] : [1, 0, 0];
		const ahead = unit(cross(up, side));
		return { ahead, left: cross(up, ahead), up };
	},
	forward() {
		const f = this.frame(), c = Math.cos(this.pitch), s = Math.sin(this.pitch);
		const level = add(f.ahead.map((x) => x * Math.cos(this.yaw)), f.left, Math.sin(this.yaw));
		return add(level.map((x) => x * c), f.up, s);
	},
	axes() {
		const forward = this.forward(), right = unit(cross(forward, scene.up));
		return { forward, right, up: cross(right, forward) };
	},
	look(direction) {
		const f = this.frame(), d = unit(direction);
		this.pitch = clamp(Math.asin(clamp(dot(d, f.up), -1, 1)), -STEEPEST, STEEPEST);
		this.yaw = Math.atan2(dot(d, f.left), dot(d, f.ahead));
	},
	/* One of the scene's. */
	choose(view) {
		this.eye = add(view.at, scene.corner, -1);
		this.pivot = add(view.to, scene.corner, -1);
		this.look(add(this.pivot, this.eye, -1));
		this.angle = view.angle;
		this.aspect = view.aspect;
		this.near = view.near;
		this.home = this.eye;
	},
	/* How near things are shown: what stood in the way of the view that was chosen stays away, where
	 * it is, until one has come as far. */
	nearest() {
		const way = norm(add(this.eye, this.home, -1));
		return Math.max(this.near - way, 0.05 * scene.spacing, 1e-7 * this.extent);
	},
	/* The tangent of half the vertical angle, in which a picture of this size shows to both sides
	 * what it was chosen for. */
	tangent(width, height) {
		return Math.tan(this.angle * Math.PI / 360) * Math.max(1, this.aspect * height / width);
	},
	/* How far away what is turned about is; never nothing. */
	distance() {
		return Math.max(norm(add(this.pivot, this.eye, -1)), 4 * scene.spacing);
	},
	turnHead(yaw, pitch) {
		this.yaw += yaw;
		this.pitch = clamp(this.pitch + pitch, -STEEPEST, STEEPEST);
	},
	orbit(yaw, pitch) {
		const off = add(this.eye, this.pivot, -1), a = this.axes();
		const local = [dot(off, a.right), dot(off, a.up), dot(off, a.forward)];
		this.turnHead(yaw, pitch);
		const b = this.axes();
		this.eye = [0, 1, 2].map((k) => this.pivot[k] + local[0] * b.right[k] +
			local[1] * b.up[k] + local[2] * b.forward[k]);
	},
	/* Metres to the right, upwards, ahead. */
	move(right, up, ahead) {
		const a = this.axes();
		const way = [0, 1, 2].map((k) => right * a.right[k] + up * a.up[k] + ahead * a.forward[k]);
		this.eye = add(this.eye, way);
		return way;
	},
	pan(right, up) {
		this.pivot = add(this.pivot, this.move(right, up, 0));
	},
	/* Nearer to what is turned about by a share of the way, or past it. */
	approach(share) {
		const far = this.distance(), step = share * Math.max(far, 0.02 * this.extent);
		const way = this.move(0, 0, step);
		if (far - step < 8 * scene.spacing)
			this.pivot = add(this.pivot, way);
	},
};

const orbits = () => document.getElementById("moving").value === "orbit";

/* What a drag by so many pixels does. */
function turn(x, y) {
	if (orbits())
		camera.orbit(-x * 0.006, -y * 0.006);
	else
		camera.turnHead(x * 0.004, y * 0.004);
}
function pan(canvas, x, y) {
	const metres = 2 * camera.distance() *
		camera.tangent(canvas.clientWidth, canvas.clientHeight) / canvas.clientHeight;
	camera.pan(-x * metres, y * metres);
}
/* One of two fingers, from one place to another. */
function pinch(canvas, before, now, other) {
	const spread = (p) => Math.hypot(p.x - other.x, p.y - other.y) || 1;
	camera.approach(clamp(1 - spread(before) / spread(now), -0.5, 0.5));
	pan(canvas, (now.x - before.x) / 2, (now.y - before.y) / 2);
}

function watchPointers(canvas, moved) {
	const down = new Map(); /* pointers: where each is */
	const place = (event) => ({ x: event.clientX, y: event.clientY });
	canvas.addEventListener("pointerdown", (event) => {
		canvas.setPointerCapture(event.pointerId);
		canvas.focus({ preventScroll: true });
		down.set(event.pointerId, place(event));
	});
	canvas.addEventListener("pointermove", (event) => {
		const before = down.get(event.pointerId), now = place(event);
		if (!before)
			return;
		if (!event.buttons) { /* it went up where nobody saw it */
			down.delete(event.pointerId);
			return;
		}
		if (down.size === 2)
			pinch(canvas, before, now, [...down].find(([id]) => id !== event.pointerId)[1]);
		else if (event.buttons & 6 || event.shiftKey)
			pan(canvas, now.x - before.x, now.y - before.y);
		else
			turn(now.x - before.x, now.y - before.y);
		down.set(event.pointerId, now);
		moved();
	});
	for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
		canvas.addEventListener(end, (event) => down.delete(event.pointerId));
}

function watchKeys(canvas, moved) {
	canvas.addEventListener("keydown", (event) => {
		const step = camera.distance() * (event.shiftKey ? 0.25 : 0.06);
		const way = (event.shiftKey ? 48 : 12) * (orbits() ? 1 : -1); /* pixels of a drag */
		const does = {
			KeyW: () => camera.move(0, 0, step), KeyS: () => camera.move(0, 0, -step),
			KeyA: () => camera.move(-step, 0, 0), KeyD: () => camera.move(step, 0, 0),
			KeyE: () => camera.move(0, step, 0), KeyQ: () => camera.move(0, -step, 0),
			ArrowLeft: () => turn(way, 0), ArrowRight: () => turn(-way, 0),
			ArrowUp: () => turn(0, way), ArrowDown: () => turn(0, -way),
		}[event.code];
		if (!does || event.ctrlKey || event.metaKey || event.altKey)
			return;
		event.preventDefault();
		does();
		moved();
	});
}

/* What pointers and keys do to the camera. `moved` is called after each change, `pick` with a place
 * on the canvas that is to be turned about. */
function watchInput(canvas, moved, pick) {
	watchPointers(canvas, moved);
	watchKeys(canvas, moved);
	canvas.addEventListener("contextmenu", (event) => event.preventDefault());
	canvas.addEventListener("wheel", (event) => {
		event.preventDefault();
		camera.approach(clamp(-event.deltaY * (event.deltaMode ? 0.03 : 0.001), -0.4, 0.4));
		moved();
	}, { passive: false });
	canvas.addEventListener("dblclick", (event) => pick(event));
}
