"""Sub-folders that every part measures with: an edit of one package's code leaves the numbers of others."""

FOLDERS: dict[str, tuple[str, ...]] = {
    "reference": (),
    "ours": (),
    "finite_elements": ("felupe",),
    "boundary": ("felupe",),
    "bar": ("calculix",),
    "calculix": ("calculix",),
    "speed": ("felupe", "speed"),
    "rods": ("rods",),
}
