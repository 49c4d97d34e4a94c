"""Real interfaces: what is said on the wire, what a device may do, and its state machine.

`ports` (the seams, one method wide), `safety` (limits and who stops by itself), `cobs` and
`frames` (bytes on the wire), `messages` (what a frame says), `tile` (amplitude over position),
`playing` (envelopes, tile), `loads` (heat and duty), `reports` (readings), `machine` (the state machine that `firmware/` writes in C). Pure: time
is passed in. Imports no physics.
"""
