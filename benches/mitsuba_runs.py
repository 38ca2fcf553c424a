"""What the scripts here that run Mitsuba 3 share."""


def to_numpy(mi, image):
    """A rendered tensor as a NumPy array in double precision. The array is there only once the kernels have run."""
    import numpy as np

    if "llvm" in mi.variant() or "cuda" in mi.variant():
        import drjit as dr

        dr.eval(image)
        dr.sync_thread()
    return np.array(image, dtype=np.float64)


def mean_and_variance(mi, scene, spp, seeds):
    """The mean of so many independent renderings, each of `spp` samples per pixel, and the variance of that mean."""
    import numpy as np

    runs = [to_numpy(mi, mi.render(scene, spp=spp, seed=seed + 1))[..., :3] for seed in range(seeds)]
    return np.mean(runs, axis=0), np.var(runs, axis=0, ddof=1) / seeds
