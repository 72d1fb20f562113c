"""Measuring: what ``integrable run`` finds of a scene, and ``integrable report`` of many.

What is measured is a list of tasks (:mod:`.plan`), each one scene × method × setting; :mod:`.measure` does one, against
the :mod:`.truth` of its scene. The tasks of a scene's own ``[report]`` are done in process (:mod:`.motions`, beside it
:mod:`.orbits`), for :mod:`.run`. Those of a study begin from doubles (:mod:`integrable.scene.doubles`), are done in
worker processes under time limits (:mod:`.runner`) and kept in files (:mod:`.store`), so that a study that was killed
goes on where it was, and two at once share the work; :mod:`.findings` says what they show, :mod:`.page` and
:mod:`.figures` show it.
"""
