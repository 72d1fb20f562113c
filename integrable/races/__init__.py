"""Races: a user's integrator against those of :mod:`integrable.oracles`, on problems whose solution is known.

    from integrable.races.race import race
    race(["t_handle"], {"mine": solve})        # solve(problem, times, tolerance): states, shape (len(times), n)

:mod:`.race` runs the methods, :mod:`.entrants` defines how each is run and timed, :mod:`.page` draws the page.
"""
