"""Opens results in ParaView: the deformed bodies, coloured by a field.

    pvbatch inputs/open_in_paraview.py FILE [PICTURE.png]       a picture of the last step; without a display: xvfb-run -a pvbatch ...
    BRICKWALL_RESULTS=FILE paraview --script=inputs/open_in_paraview.py

FILE is a joined Exodus file, such as out/brick_wall/brick_wall.exo, or one of the files of ranks, brick_wall.exo.4.0: the
others are opened with it. In the environment, SCALE is a factor on the displacements, and FIELD the beginning of the name of
a nodal or an element field, such as contact_pressure (of vectors the magnitude is shown); default displacement.
"""
import glob
import math
import os
import re
import sys

from paraview.simple import *

path = sys.argv[1] if len(sys.argv) > 1 else os.environ.get("BRICKWALL_RESULTS")
if not path or not os.path.exists(path):
    sys.exit(f"open_in_paraview.py: there is no file {path}")
rank_file = re.fullmatch(r"(.+\.\d+)\.\d+", path)
files = sorted(glob.glob(glob.escape(rank_file[1]) + ".*")) if rank_file else [path]

reader = IOSSReader(FileName=files)
reader.ApplyDisplacements = 1
reader.DisplacementMagnitude = float(os.environ.get("SCALE", 1))
reader.UpdatePipelineInformation()
times = list(reader.TimestepValues or [0.0])
reader.UpdatePipeline(times[-1])
field = os.environ.get("FIELD", "displacement")
data = next(((kind, name, array.GetNumberOfComponents()) for kind, arrays in (("POINTS", reader.PointData), ("CELLS", reader.CellData))
             for name, array in arrays.items() if name.startswith(field)), None)
if not data and "FIELD" in os.environ:
    sys.exit(f"open_in_paraview.py: there is no field {field}; there are {', '.join(reader.PointData.keys() + reader.CellData.keys())}")

view = GetActiveViewOrCreate("RenderView")
view.ViewSize = [1500, 1125]
view.ViewTime = times[-1]
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesLabelColor = [0, 0, 0]
shown = Show(reader, view)
shown.Representation = "Surface With Edges"
shown.EdgeColor = [0.3, 0.3, 0.3]
if data:
    kind, name, components = data
    ColorBy(shown, (kind, name, "Magnitude") if components > 1 else (kind, name))
    colours = GetColorTransferFunction(name)
    colours.ApplyPreset("Viridis (matplotlib)", True)
    shown.RescaleTransferFunctionToDataRange(False)
    shown.SetScalarBarVisibility(view, True)
    bar = GetScalarBar(colours, view)
    bar.Title, bar.TitleColor, bar.LabelColor = name.strip("_").replace("_", " "), [0, 0, 0], [0, 0, 0]
azimuth, elevation = math.radians(62), math.radians(18)  # as brickwall-plot: from x towards y, and from the ground
view.CameraFocalPoint = [0, 0, 0]
view.CameraPosition = [math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)]
view.CameraViewUp = [0, 0, 1]
view.ResetCamera(True)

information = reader.GetDataInformation()
print(f"{len(files)} files, {len(times)} steps, {information.GetNumberOfPoints()} points, {information.GetNumberOfCells()} cells, "
      f"bounds at time {times[-1]:g}: {' '.join(f'{bound:.6g}' for bound in information.GetBounds())}")
if len(sys.argv) > 2:
    SaveScreenshot(sys.argv[2], view)
else:
    Render()
