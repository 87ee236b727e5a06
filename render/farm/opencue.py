#!/usr/bin/env python3
"""One picture by OpenCue: a layer for pass one, a layer whose frames are slices, a layer for the merge.

    render/farm/opencue.py SCENE PICTURE SLICES [RENDER OPTIONS]     options must hold --spp, of the whole picture

Needs pyoutline (opencue-pyoutline). SHOW and SHOT in the environment name where the job belongs. A frame that fails
may be retried in CueGUI: it goes on from its checkpoint.
"""

import getpass
import os
import sys

import outline
import outline.cuerun
import outline.modules.shell


def main(arguments):
    if len(arguments) < 3:
        sys.exit(__doc__)
    scene, picture, slices = os.path.realpath(arguments[0]), os.path.realpath(arguments[1]), int(arguments[2])
    options = arguments[3:]
    step = os.path.join(os.path.dirname(os.path.realpath(__file__)), "step.sh")
    folder = picture + ".farm"

    def layer(name, command, frames="1-1", after=None):
        made = outline.modules.shell.Shell(name, command=[step] + command, chunk=1, range=frames)
        if after:
            made.depend_on(after)
        job.add_layer(made)
        return made

    job = outline.Outline("twopass_" + os.path.basename(picture).replace(".", "_"),
                          shot=os.environ.get("SHOT", "shot"), show=os.environ.get("SHOW", "testing"),
                          user=getpass.getuser())
    solve = layer("solve", ["solve", scene, folder] + options)
    slice_ = layer("slice", ["slice", scene, folder, "#IFRAME#", str(slices)] + options, f"1-{slices}", solve)
    layer("merge", ["merge", folder, picture], after=slice_)
    outline.cuerun.launch(job, use_pycuerun=False)


if __name__ == "__main__":
    main(sys.argv[1:])
