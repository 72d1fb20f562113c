"""Measurements: the results of ``integrable run`` for a scene, and of ``integrable report`` for many.

A measurement is a list of tasks (:mod:`.plan`), each of one scene, one method and one setting. :mod:`.measure` measures
one, against the :mod:`.truth` of its scene. The tasks of a scene's own ``[report]`` run in this process
(:mod:`.motions`, :mod:`.orbits`), for :mod:`.run`. The tasks of a study start from doubles
(:mod:`integrable.scene.doubles`) and run in worker processes under time limits (:mod:`.runner`). Their results are
files (:mod:`.store`), so a study that was killed resumes where it stopped, and two studies in one folder share the
work. :mod:`.findings` evaluates them, :mod:`.page` and :mod:`.figures` show them.
"""
