"""Whatever a host sends, and when: the limits hold, by an independent watch."""

import random
from collections import Counter

import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule, run_state_machine_as_test

from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.held import HeldPlate
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, Fault, State

from .adversary import Adversary
from .recording import Resonator


class Watch:
    """Watches the output with floats of its own, by what docs/development/protocol.md promises."""

    def __init__(self) -> None:
        resonator = Resonator()
        loops = HeldPlate(lambda: resonator.shown(random.Random(self.now), self.machine, self.now))
        self.machine = Machine(3, sensor=self.finger, pickup=lambda: 7, loops=loops)
        self.now = self.heard = 0
        self.level = 0
        self.on = 0.0
        self.seen: Counter[object] = Counter()
        self.answers = Deframer()

    def finger(self) -> tuple[int, int, bool]:
        """Walks over the tile and past either end; now and then it does not touch."""
        return self.now // 7 % 3000 - 1500, 0, self.now % 5_000 > 500

    def send(self, data: bytes) -> None:
        level = self.machine.level
        for frame in self.answers.take(self.machine.receive(data, self.now)):
            assert frame is not None
            status = m.ANSWERS[frame.type].read(frame.payload)
            assert status is not None
            self.seen[type(status)] += 1
            if not isinstance(status, m.Status):
                continue
            if status.reason == 0:
                self.heard = self.now
            self.seen["reason", status.reason] += 1
        assert self.machine.level == level  # no time has passed: nothing moved

    def wait(self, elapsed: int) -> None:
        self.now += elapsed
        before, limits = self.level, self.machine.limits
        self.level = self.machine.tick(self.now & 0xFFFFFFFF)
        for frame in self.answers.take(self.machine.outgoing()):
            assert frame is not None
            reading = m.Reading.read(frame.payload)
            assert reading is not None
            assert reading.level == self.level
            self.seen[m.Reading] += 1
        self.seen[self.machine.state] += 1
        self.seen[self.machine.fault] += 1
        if limits is None:
            assert self.level == 0
            return
        assert 0 <= self.level <= limits.voltage
        change = self.level - before
        assert -limits.slew * elapsed <= change <= limits.slew * min(elapsed, 1000)
        if self.now - self.heard >= 60_000:
            assert self.level == 0
        if change > 0:
            assert self.machine.state is State.PLAYING
        if self.machine.state is State.PLAYING:
            frequency = self.machine.frequency
            assert limits.lowest_frequency <= frequency <= limits.highest_frequency
        # On for at most duty·(T + window), and one tick and one ramp to notice and to stop.
        duty = limits.duty / 1000
        self.on = max(0.0, self.on + (1 if before else 0) * elapsed - duty * elapsed)
        if 0 < elapsed <= 1_000 and self.machine.state is State.PLAYING:
            assert self.on <= duty * limits.duty_window * 1000 + 1


TOTAL: Counter[object] = Counter()


class AdversarialHost(RuleBasedStateMachine):
    """Hypothesis chooses the order of commands, times and damage."""

    def __init__(self) -> None:
        super().__init__()
        self.watch = Watch()
        self.host = Adversary(random.Random(0))

    @rule(seed=st.integers(0, 2**32), ticks=st.integers(1, 4))
    def act(self, seed: int, ticks: int) -> None:
        """One step of the adversary, then some ticks."""
        self.host.random.seed(seed)
        TOTAL["steps"] += 1
        self.watch.send(self.host.step(self.watch.machine))
        for _ in range(ticks):
            self.watch.wait(self.host.pause())

    @rule(seed=st.integers(0, 2**32))
    def behave(self, seed: int) -> None:
        """The next sensible command, and half a millisecond."""
        self.host.random.seed(seed)
        TOTAL["steps"] += 1
        self.host.sequence += 1
        message = self.host._next_of_a_session(self.watch.machine)
        self.watch.send(message.frame(self.host.sequence).encoded())
        self.watch.wait(500)

    @rule()
    def trip(self) -> None:
        """The amplifier faults."""
        TOTAL["steps"] += 1
        self.watch.machine.trip()
        assert self.watch.machine.state is State.FAULT

    @invariant()
    def a_fault_is_latched_with_its_name(self) -> None:
        """FAULT and no fault never go together, nor the other way round."""
        machine = self.watch.machine
        assert (machine.state is State.FAULT) == (machine.fault is not Fault.NONE)


def run(examples: int, steps: int) -> None:
    TOTAL.clear()
    run_state_machine_as_test(
        AdversarialHost,
        settings=settings(
            max_examples=examples,
            stateful_step_count=steps,
            deadline=None,
            derandomize=True,
            database=None,
            phases=[Phase.generate, Phase.shrink],
            suppress_health_check=list(HealthCheck),
        ),
    )


@pytest.mark.slow
def test_the_limits_hold_over_adversarial_commands() -> None:
    run(250, 60)
    assert TOTAL["steps"] >= 10_000


@pytest.mark.nightly
def test_the_limits_hold_over_many_adversarial_commands() -> None:
    run(2500, 60)
    assert TOTAL["steps"] >= 100_000


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2, 3))]
)
def test_the_limits_hold_over_long_sessions_that_see_everything(seed: int) -> None:
    watch, host = Watch(), Adversary(random.Random(seed))
    for number, message in enumerate((m.Hello(1), m.Arm(3))):  # before it has limits
        watch.send(message.frame(number).encoded())
    for _ in range(8_000):
        watch.send(host.step(watch.machine))
        watch.wait(host.pause())
        if host.random.random() < 0.002:
            watch.machine.trip()
        watch.wait(500)
    assert set(State) | set(Fault) <= set(watch.seen)
    assert {("reason", number) for number in (*range(10), 11)} <= set(watch.seen)
    assert {m.Status, m.Reading, m.Info, m.Capabilities, m.Loops} <= set(watch.seen)
