// What a finger meets, in the page: place → texture → envelope → friction → tangential force.
// The texture runs by the same program as a device's loop; the envelope is the resonator's exact
// step response; friction is read from the display's table over speed and amplitude.

import { Renderer } from "./renderer.js";

const RESTING = 1e-4;
// Of the speed: pointer events come some hundred times a second with a jitter of their own.
const SPEED_TIME = 0.015;

/** The value of a table over an even abscissa from 0 to `last`. */
function lookup(values, last, at) {
  const place = Math.max(0, Math.min(1, at / last)) * (values.length - 1);
  const k = Math.min(values.length - 2, Math.floor(place)), share = place - k;
  return (1 - share) * values[k] + share * values[k + 1];
}

/** The relative friction at an amplitude (m) and a finger's speed (m/s; without one the nominal). */
export function frictionAt(ready, amplitude, speed = ready.nominal_finger_speed_m_per_s) {
  const speeds = ready.finger_speed_m_per_s, rows = ready.relative_friction;
  const pace = Math.min(Math.abs(speed), speeds.at(-1));
  let k = 0;
  while (k < speeds.length - 2 && speeds[k + 1] <= pace) k += 1;
  const below = lookup(rows[k], ready.largest_amplitude_m, amplitude);
  if (speeds.length === 1) return below;
  const share = (pace - speeds[k]) / (speeds[k + 1] - speeds[k]);
  return (1 - share) * below + share * lookup(rows[k + 1], ready.largest_amplitude_m, amplitude);
}

export class Finger {
  constructor(ready, { wave = false } = {}) {
    this.ready = ready;
    this.wave = wave;
    this.renderer = new Renderer(ready.program);
    this.reset();
  }

  reset() {
    this.renderer.reset();
    Object.assign(this, { time: null, x: 0, y: 0, speed: 0, direction: 0, amplitude: 0, wanted: 0, velocity: 0 });
  }

  /** One sample of the pointer: place (m) and time (s). Returns what the finger meets now. */
  move(x, y, time) {
    const { ready } = this;
    if (this.time === null) {
      this.time = time - 1e-3;
      this.x = x;
      this.y = y;
    }
    const dt = time - this.time;
    if (dt > 0) {
      const along = ready.wave?.along === "y" ? y - this.y : x - this.x;
      const velocity = along / dt, share = 1 - Math.exp(-dt / SPEED_TIME);
      this.velocity += share * (velocity - this.velocity);
      this.speed = Math.abs(this.velocity);
      if (this.speed > RESTING) this.direction = Math.sign(this.velocity);
      this.wanted = this.renderer.tick(x, y, this.velocity, time);
      const kept = Math.exp(-dt / ready.envelope_time_constant_s);
      this.amplitude = this.wanted + (this.amplitude - this.wanted) * kept;
    }
    Object.assign(this, { time, x, y });
    return this.met();
  }

  met() {
    const { ready } = this;
    const place = ready.wave?.along === "y" ? this.y : this.x;
    const factor = this.wave && ready.wave ? waveFactor(ready.wave, place) : 1;
    // The program chooses amplitudes for no slower finger; shown at rest, so that a texture is what
    // it asks for and does not fall to nothing where the finger stops.
    const pace = Math.max(this.speed, ready.lowest_finger_speed_m_per_s);
    const friction = frictionAt(ready, this.amplitude * factor, pace);
    const force = this.speed > RESTING ? ready.friction_coefficient * friction * ready.normal_force_N : 0;
    return {
      x: this.x, y: this.y, speed: this.speed, wanted: this.wanted, amplitude: this.amplitude,
      friction, frictionWanted: frictionAt(ready, this.wanted, pace), pace,
      force: force * this.direction, factor,
      lag: this.speed * ready.envelope_time_constant_s,
    };
  }
}

/** The amplitude that the pad meets over the antinode's, from the wave's table over a period. */
export function waveFactor(wave, x) {
  const turn = x / wave.period_m - Math.floor(x / wave.period_m);
  return lookup(wave.factor, 1, turn);
}

/** Whether this page's interpreter gives the compiled one's amplitudes; the greatest difference. */
export function parity(program, samples) {
  const renderer = new Renderer(program);
  let worst = 0;
  for (let k = 0; k < samples.t_s.length; k += 1) {
    const x = samples.x_m[k] === null ? NaN : samples.x_m[k];
    const found = renderer.tick(x, samples.y_m[k], samples.v_m_per_s[k], samples.t_s[k]);
    worst = Math.max(worst, Math.abs(found - samples.amplitude_m[k]));
  }
  return { ticks: samples.t_s.length, worst };
}
