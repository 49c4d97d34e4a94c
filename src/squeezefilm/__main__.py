"""`python -m squeezefilm` is `squeezefilm`."""

from squeezefilm.cli import main

if __name__ == "__main__":
    main()
