// The predicted vibration of the skin as sound: the texture at the audio rate along the pointer's
// motion, friction, and the fingerpad as mass, spring and damper. Runs on the audio thread.

import { frictionAt } from "./finger.js";
import { Renderer } from "./renderer.js";

const STALE = 0.08;

class SkinSound extends AudioWorkletProcessor {
  constructor() {
    super();
    this.port.onmessage = ({ data }) => {
      if (data.ready) this.load(data.ready);
      if (data.place) {
        this.goal = data.place;
        this.heard = currentTime;
      }
    };
  }

  load(ready) {
    this.ready = ready;
    this.renderer = new Renderer(ready.program);
    const { mass, stiffness, damping } = ready.skin;
    // Semi-implicit steps of a stiff oscillator: eight to a sample keep it stable and true.
    this.skin = { mass, stiffness, damping, stretch: 0, velocity: 0 };
    this.mean = 0;
    this.x = null;
  }

  process(_, [[out]]) {
    if (!this.ready || !this.goal || currentTime - this.heard > STALE) {
      if (this.skin) this.skin.velocity = 0;
      return true;
    }
    const { ready, skin, goal } = this, dt = 1 / sampleRate;
    if (this.x === null) {
      this.x = goal.x;
      this.amplitude = 0;
    }
    // The pointer's place is late and seldom: glide to where it will be.
    const pull = 1 - Math.exp(-dt / 0.01);
    const kept = Math.exp(-dt / ready.envelope_time_constant_s);
    for (let k = 0; k < out.length; k += 1) {
      const time = currentTime + k * dt;
      const aim = goal.x + goal.velocity * (time - this.heard);
      const before = this.x;
      this.x += goal.velocity * dt + pull * (aim - this.x);
      const velocity = (this.x - before) / dt;
      const wanted = this.renderer.tick(this.x, goal.y, velocity, time);
      this.amplitude = wanted + (this.amplitude - wanted) * kept;
      const friction = frictionAt(ready, this.amplitude, velocity);
      const force = Math.abs(velocity) > 1e-4
        ? Math.sign(velocity) * ready.friction_coefficient * friction * ready.normal_force_N : 0;
      for (let j = 0; j < 8; j += 1) {
        skin.velocity += ((force - skin.stiffness * skin.stretch - skin.damping * skin.velocity) / skin.mass) * (dt / 8);
        skin.stretch += skin.velocity * (dt / 8);
      }
      this.mean += 1e-3 * (skin.velocity - this.mean);
      out[k] = Math.max(-1, Math.min(1, 4 * (skin.velocity - this.mean)));
    }
    return true;
  }
}

registerProcessor("skin-sound", SkinSound);
