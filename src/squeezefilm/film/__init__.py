"""The gas film between a vibrating surface and a finger: compressible Reynolds, solved."""
