"""Calibrates a camera with OpenCV from pictures of a target: PATTERN COLUMNS ROWS SPACING PICTURE...

Prints a line for each of fx fy cx cy k1 k2: value and OpenCV's own standard deviation; then the rms reprojection error and
how many pictures the target was found in."""
import sys

import cv2
import numpy as np

pattern, columns, rows, spacing = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
grid = np.zeros((rows * columns, 3), np.float32)
grid[:, :2] = np.mgrid[0:columns, 0:rows].T.reshape(-1, 2) * spacing
on_target, on_picture, size = [], [], None
for name in sys.argv[5:]:
    picture = cv2.imread(name, cv2.IMREAD_GRAYSCALE)
    size = picture.shape[::-1]
    if pattern == "chessboard":
        found, marks = cv2.findChessboardCorners(picture, (columns, rows))
        if found:
            stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 60, 1e-4)
            marks = cv2.cornerSubPix(picture, marks, (4, 4), (-1, -1), stop)
    else:
        found, marks = cv2.findCirclesGrid(picture, (columns, rows), flags=cv2.CALIB_CB_SYMMETRIC_GRID)
    if found:
        on_target.append(grid)
        on_picture.append(marks.reshape(-1, 1, 2).astype(np.float32))
flags = cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST
error, matrix, distortion, _, _, deviations, _, _ = cv2.calibrateCameraExtended(
    on_target, on_picture, size, None, None, flags=flags)
values = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *distortion.ravel()[:2]]
for value, deviation in zip(values, deviations.ravel()[:6]):
    print(value, deviation)
print(error, len(on_picture))
