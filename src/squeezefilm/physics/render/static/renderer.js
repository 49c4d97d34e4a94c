// The renderer's interpreter for a page: the same programs, operation by operation, as the compiled
// ones (squeezefilm.physics.render.interpret for a value, squeezefilm.physics.render.program.interpreter
// for a tick). Programs and states are Float64Arrays laid out as
// squeezefilm.physics.render.program.layout says; opcodes are explained in squeezefilm.physics.render.opcodes.
// An ES module with no imports and no build step.

export const MAGIC = 0x53515a46;
export const VERSION = 2; // 1 is understood too: it knows no speeds of the inverse
export const HEADER = 24;
export const STATE = 20;

const CODE = 3, TABLES = 4, STACK = 5, QUANTITY = 6, FRICTION = 7, LARGEST = 8;
const INVERSE = 9, INVERSE_COUNT = 10, HOLD = 11, FADE = 12;
const WAVE = 13, WAVE_COUNT = 14, WAVE_PERIOD = 15, WAVE_P = 16, WAVE_Q = 17, WAVE_R = 18;
const FARTHEST = 19, INVERSE_SPEEDS = 20;

const LAST_TIME = 0, STARTED = 1, HELD = 2, IDLE = 3, AMPLITUDE = 4, WANTED = 5, FLAGS = 6;
const TICKS = 7, BAD_PLACE = 8, BAD_TIME = 9, BACKWARDS = 10, REPEATED = 11, BAD_VALUE = 12;
const STALLS = 13, TOO_STICKY = 14, TOO_SLIPPERY = 15, NEGATIVE = 16, SATURATED = 17;

const COUNTERS = {
  ticks: TICKS, badPlace: BAD_PLACE, badTime: BAD_TIME, backwards: BACKWARDS, repeated: REPEATED,
  badValue: BAD_VALUE, stalls: STALLS, tooSticky: TOO_STICKY, tooSlippery: TOO_SLIPPERY,
  negative: NEGATIVE, saturated: SATURATED,
};

const FASTEST = 1000;
const REACH = 1e-9;
const WHOLE = 2 ** -32;
const FARTHEST_CELL = 2 ** 31;
const STEP_ALONG = 0x9e3779b1;
const STEP_ACROSS = 0x85ebca77;

// Numbers that follow each opcode.
const OPERANDS = [
  0, 1, 3, 2, 0, 0, 0, 0, 0, 0, 0, 2, 3, 2, 2, 2, 2, 0, 3, 3, 2, 2, 7, 2, 2, 1, 2, 3, 0, 1,
];

function hold(value, low, high) {
  const above = value > low ? value : low;
  return above < high ? above : high;
}

// "lowbias32" (C. Wellons, Hash Prospector, public domain), as in pattern_noise.
function mixed(value) {
  value ^= value >>> 16;
  value = Math.imul(value, 0x7feb352d);
  value ^= value >>> 15;
  value = Math.imul(value, 0x846ca68b);
  return (value ^ (value >>> 16)) >>> 0;
}

function spline(f, a, b, c, d) {
  const g = 1 - f;
  return (
    ((g * g * g) / 6) * a
    + ((4 + f * f * (3 * f - 6)) / 6) * b
    + ((4 + g * g * (3 * g - 6)) / 6) * c
    + ((f * f * f) / 6) * d
  );
}

function lineNoise(u, seed, step) {
  if (!(Math.abs(u) < FARTHEST_CELL)) return NaN;
  const cell = Math.floor(u);
  return spline(
    u - cell,
    mixed(seed ^ Math.imul(cell - 1, step)) * WHOLE,
    mixed(seed ^ Math.imul(cell, step)) * WHOLE,
    mixed(seed ^ Math.imul(cell + 1, step)) * WHOLE,
    mixed(seed ^ Math.imul(cell + 2, step)) * WHOLE,
  );
}

function fieldNoise(u, w, seed) {
  if (!(Math.abs(u) < FARTHEST_CELL)) return NaN;
  const cell = Math.floor(u);
  return spline(
    u - cell,
    lineNoise(w, mixed(seed ^ Math.imul(cell - 1, STEP_ALONG)), STEP_ACROSS),
    lineNoise(w, mixed(seed ^ Math.imul(cell, STEP_ALONG)), STEP_ACROSS),
    lineNoise(w, mixed(seed ^ Math.imul(cell + 1, STEP_ALONG)), STEP_ACROSS),
    lineNoise(w, mixed(seed ^ Math.imul(cell + 2, STEP_ALONG)), STEP_ACROSS),
  );
}

function wrapped(value, count) {
  return ((value % count) + count) % count;
}

function image(program, pc, x, y) {
  const start = program[TABLES] + program[pc];
  const rows = program[pc + 1], columns = program[pc + 2];
  const pixel = program[pc + 5], outside = program[pc + 6];
  let u = (x - program[pc + 3]) / pixel;
  let w = (y - program[pc + 4]) / pixel;
  if (!(Math.abs(u) < FARTHEST_CELL && Math.abs(w) < FARTHEST_CELL)) return NaN;
  if (outside === 2 && !(u >= 0 && u <= columns && w >= 0 && w <= rows)) return 0;
  if (outside === 1) {
    u -= columns * Math.floor(u / columns) + 0.5;
    w -= rows * Math.floor(w / rows) + 0.5;
  } else {
    u = hold(u - 0.5, 0, columns - 1);
    w = hold(w - 0.5, 0, rows - 1);
  }
  let i = Math.floor(u), j = Math.floor(w);
  const fu = u - i, fw = w - j;
  let i1, j1;
  if (outside === 1) {
    i1 = wrapped(i + 1, columns);
    j1 = wrapped(j + 1, rows);
    i = wrapped(i, columns);
    j = wrapped(j, rows);
  } else {
    i1 = Math.min(i + 1, columns - 1);
    j1 = Math.min(j + 1, rows - 1);
  }
  const row = start + (rows - 1 - j) * columns;
  const nextRow = start + (rows - 1 - j1) * columns;
  const low = (1 - fu) * program[row + i] + fu * program[row + i1];
  if (nextRow === row) return low;
  const high = (1 - fu) * program[nextRow + i] + fu * program[nextRow + i1];
  return (1 - fw) * low + fw * high;
}

/** The texture's value, in its quantity; the stack is `memory` from `base` on. */
export function interpret(program, memory, base, x, y, v, t) {
  let pc = program[CODE];
  let top = base - 1;
  for (;;) {
    const code = program[pc];
    pc += 1;
    let s, u;
    switch (code) {
      case 0: // END
        return memory[top];
      case 1: // CONSTANT
        memory[++top] = program[pc];
        break;
      case 2: // ALONG
        memory[++top] = program[pc] * x + program[pc + 1] * y + program[pc + 2];
        break;
      case 3: { // RADIUS
        const dx = x - program[pc], dy = y - program[pc + 1];
        memory[++top] = Math.sqrt(dx * dx + dy * dy);
        break;
      }
      case 4: // TIME
        memory[++top] = t;
        break;
      case 5: // SPEED
        memory[++top] = Math.abs(v);
        break;
      case 6: // ADD
        top -= 1;
        memory[top] += memory[top + 1];
        break;
      case 7: // MULTIPLY
        top -= 1;
        memory[top] *= memory[top + 1];
        break;
      case 8: // LEAST
        top -= 1;
        if (memory[top + 1] < memory[top]) memory[top] = memory[top + 1];
        break;
      case 9: // GREATEST
        top -= 1;
        if (memory[top + 1] > memory[top]) memory[top] = memory[top + 1];
        break;
      case 10: // COMPLEMENT
        memory[top] = 1 - memory[top];
        break;
      case 11: // BETWEEN
        s = memory[top];
        memory[top] = (1 - s) * program[pc] + s * program[pc + 1];
        break;
      case 12: // SQUARE
        u = memory[top] / program[pc] + program[pc + 1];
        memory[top] = u - Math.floor(u) < program[pc + 2] ? 1 : 0;
        break;
      case 13: // SINE
        u = memory[top] / program[pc] + program[pc + 1];
        memory[top] = 0.5 + 0.5 * Math.sin(2 * Math.PI * u);
        break;
      case 14: // GAUSSIAN
        u = (memory[top] - program[pc]) / program[pc + 1];
        memory[top] = Math.exp(-0.5 * (u * u));
        break;
      case 15: // HANN
        u = Math.abs(memory[top] - program[pc]) / program[pc + 1];
        memory[top] = u < 1 ? 0.5 + 0.5 * Math.cos(Math.PI * u) : 0;
        break;
      case 16: // RAMP
        memory[top] = hold((memory[top] - program[pc]) / (program[pc + 1] - program[pc]), 0, 1);
        break;
      case 17: // SMOOTH
        s = memory[top];
        memory[top] = s * s * (3 - 2 * s);
        break;
      case 18: { // BAND
        s = memory[top];
        const start = program[pc], end = program[pc + 1], fade = program[pc + 2];
        memory[top] = fade === 0
          ? (s >= start && s < end ? 1 : 0)
          : hold(Math.min(s - start, end - s) / fade + 0.5, 0, 1);
        break;
      }
      case 19: { // BUMP
        u = (memory[top] - program[pc]) / program[pc + 1];
        const way = v < 0 ? -program[pc + 2] : program[pc + 2];
        memory[top] = hold(0.5 - 0.5 * way * u * Math.exp(0.5 * (1 - u * u)), 0, 1);
        break;
      }
      case 20: // NOISE
        memory[top] = lineNoise(memory[top] / program[pc], program[pc + 1], STEP_ALONG);
        break;
      case 21: // NOISE_FIELD
        memory[++top] = fieldNoise(x / program[pc], y / program[pc], program[pc + 1]);
        break;
      case 22: // IMAGE
        memory[++top] = image(program, pc, x, y);
        break;
      case 23: // WITHIN
        s = memory[top];
        memory[top] = s > program[pc] && s < program[pc + 1] ? 1 : 0;
        break;
      case 24: // DECAY
        s = memory[top] - program[pc];
        memory[top] = Math.exp(-(s > 0 ? s : 0) / program[pc + 1]);
        break;
      case 25: // FADE
        top -= 1;
        s = memory[top + 1];
        memory[top] = (1 - s) * program[pc] + s * memory[top];
        break;
      case 26: { // CROSS
        top -= 2;
        const edge = program[pc], fade = program[pc + 1];
        s = memory[top + 2];
        if (fade === 0) s = s < edge ? 0 : 1;
        else s = hold((s - edge) / fade + 0.5, 0, 1);
        memory[top] = (1 - s) * memory[top] + s * memory[top + 1];
        break;
      }
      case 27: // ENTER_SCALE
        u = hold(Math.abs(v) / program[pc], program[pc + 1], program[pc + 2]);
        memory[top + 1] = x;
        memory[top + 2] = y;
        top += 2;
        x /= u;
        y /= u;
        break;
      case 28: // LEAVE_SCALE
        top -= 2;
        x = memory[top];
        y = memory[top + 1];
        memory[top] = memory[top + 2];
        break;
      case 29: // WEIGH
        memory[top] *= program[pc];
        break;
      default:
        return NaN;
    }
    pc += OPERANDS[code];
  }
}

// Where the inverse's row at or below the speed of v begins, and the share of the next.
function frictionRow(program, v) {
  const count = program[INVERSE_COUNT], speeds = program[INVERSE_SPEEDS];
  const first = program[INVERSE] + count;
  if (speeds === 0) return [first, 0];
  const place = first + count * speeds;
  const pace = Math.abs(v);
  if (pace <= program[place]) return [first, 0];
  let low = 0, high = speeds - 1;
  if (pace >= program[place + high]) return [first + count * (high - 1), 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (program[place + middle] <= pace) low = middle;
    else high = middle;
  }
  const below = program[place + low];
  return [first + count * low, (pace - below) / (program[place + high] - below)];
}

// Friction at a knot of a row, with the share of the next row there.
function frictionAt(program, place, count, share) {
  if (share === 0) return program[place];
  return (1 - share) * program[place] + share * program[place + count];
}

// The least amplitude of a relative friction within a row, by bisection.
function inverse(program, row, share, wanted) {
  const count = program[INVERSE_COUNT];
  let low = 0, high = count - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (frictionAt(program, row + middle, count, share) > wanted) low = middle;
    else high = middle;
  }
  const above = frictionAt(program, row + low, count, share);
  let part = 0;
  // Equal where friction is flat from rest on.
  if (above > wanted) {
    part = (above - wanted) / (above - frictionAt(program, row + high, count, share));
  }
  const amplitude = program[INVERSE];
  return (1 - part) * program[amplitude + low] + part * program[amplitude + high];
}

function waveFactor(program, x, y) {
  const count = program[WAVE_COUNT], start = program[WAVE];
  let u = (program[WAVE_P] * x + program[WAVE_Q] * y + program[WAVE_R]) / program[WAVE_PERIOD];
  u = (u - Math.floor(u)) * count;
  let i = Math.floor(u);
  const f = u - i;
  i %= count;
  return (1 - f) * program[start + i] + f * program[start + ((i + 1) % count)];
}

/**
 * The vibration amplitude (m, zero-to-peak) for one sample: place (m), velocity (m/s), time (s).
 * Never throws; what it does with a sample that cannot be used is told in interpreter.tick.
 */
export function tick(program, state, x, y, v, t) {
  state[TICKS] += 1;
  let flags = 0;
  const far = program[FARTHEST];
  if (!(Math.abs(x) <= far && Math.abs(y) <= far && Math.abs(v) <= FASTEST)) {
    flags |= 1;
    state[BAD_PLACE] += 1;
  }
  if (!(Math.abs(t) < Infinity)) {
    flags |= 2;
    state[BAD_TIME] += 1;
  } else if (state[STARTED] === 1) {
    if (t < state[LAST_TIME]) {
      flags |= 4;
      state[BACKWARDS] += 1;
    } else if (t === state[LAST_TIME]) {
      flags |= 8;
      state[REPEATED] += 1;
    }
  }
  if (flags === 0) {
    const wanted = interpret(program, state, STATE, x, y, v, t);
    state[WANTED] = wanted;
    if (Math.abs(wanted) < Infinity) {
      state[FLAGS] = 0;
      const amplitude = reachable(program, state, wanted, x, y, v);
      state[STARTED] = 1;
      state[LAST_TIME] = t;
      state[HELD] = amplitude;
      state[IDLE] = 0;
      state[AMPLITUDE] = amplitude;
      return amplitude;
    }
    flags |= 16;
    state[BAD_VALUE] += 1;
  }
  const idle = state[IDLE] + 1;
  const late = idle - program[HOLD];
  let amplitude = state[HELD];
  if (late > 0) {
    flags |= 32;
    if (late === 1) state[STALLS] += 1;
    amplitude *= Math.max(1 - late / program[FADE], 0);
  }
  state[IDLE] = idle;
  state[AMPLITUDE] = amplitude;
  state[FLAGS] = flags;
  return amplitude;
}

function reachable(program, state, wanted, x, y, v) {
  const largest = program[LARGEST];
  let amplitude = wanted;
  if (program[QUANTITY] !== 0) {
    const friction = program[QUANTITY] === 2 ? 1 - wanted / program[FRICTION] : wanted;
    const count = program[INVERSE_COUNT];
    const [row, share] = frictionRow(program, v);
    const most = frictionAt(program, row, count, share);
    const least = frictionAt(program, row + count - 1, count, share);
    if (friction > most) {
      amplitude = 0;
      if (friction > most + REACH) raise(state, 64, TOO_STICKY);
    } else {
      if (friction < least - REACH) raise(state, 128, TOO_SLIPPERY);
      amplitude = inverse(program, row, share, friction > least ? friction : least);
    }
  }
  if (program[WAVE_COUNT] > 0) amplitude /= waveFactor(program, x, y);
  if (amplitude < 0) {
    if (amplitude < -REACH * largest) raise(state, 256, NEGATIVE);
    amplitude = 0;
  } else if (amplitude > largest) {
    if (amplitude > (1 + REACH) * largest) raise(state, 512, SATURATED);
    amplitude = largest;
  }
  return amplitude;
}

function raise(state, flag, counter) {
  state[FLAGS] |= flag;
  state[counter] += 1;
}

/** A program with its state, from the numbers of a lowered texture. Throws on what is no program. */
export class Renderer {
  constructor(numbers) {
    const program = Float64Array.from(numbers);
    const known = program[1] === 1 || program[1] === VERSION;
    if (program[0] !== MAGIC || !known || program[2] !== program.length) {
      throw new Error(`this is no whole program of version 1 or ${VERSION}`);
    }
    this.program = program;
    this.state = new Float64Array(STATE + program[STACK]);
  }

  /** The amplitude (m, zero-to-peak) for one sample. */
  tick(x, y, v, t) {
    return tick(this.program, this.state, x, y, v, t);
  }

  /** The texture's value, in its quantity, with no memory. */
  value(x, y, v, t) {
    return interpret(this.program, this.state, STATE, x, y, v, t);
  }

  /** Forget counters, time and the amplitude held. */
  reset() {
    this.state.fill(0);
  }

  /** What it met so far, by name. */
  get counters() {
    return Object.fromEntries(
      Object.entries(COUNTERS).map(([name, place]) => [name, this.state[place]]),
    );
  }

  get flags() {
    return this.state[FLAGS];
  }
}
