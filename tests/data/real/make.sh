#!/bin/sh
# Makes the files of this folder with gmsh and TetGen.
set -e
cd "$(dirname "$0")"
for order in 1 2; do
  for version in 22 41; do
    gmsh -v 1 -3 -order $order two_boxes.geo -format msh$version -o msh/ascii$version-order$order.msh
    gmsh -v 1 -3 -order $order two_boxes.geo -format msh$version -bin -o msh/binary$version-order$order.msh
  done
  gmsh -v 1 -3 -order $order two_boxes.geo -o medit/order$order.mesh
  gmsh -v 1 -3 -order $order two_boxes.geo -o vtk/ascii-order$order.vtk
  gmsh -v 1 -3 -order $order two_boxes.geo -bin -o vtk/binary-order$order.vtk
done
for version in 22 41; do
  gmsh -v 1 -3 two_groups.geo -format msh$version -o msh/two_groups$version.msh
  gmsh -v 1 -3 two_groups.geo -format msh$version -bin -o msh/two_groups$version-binary.msh
done
gmsh -v 1 -3 -part 2 two_groups.geo -format msh41 -o msh/partitioned41.msh

cp brick.poly tetgen/from1.poly
cp brick.poly tetgen/from0.poly
cp brick.poly tetgen/order2.poly
tetgen -pqAQ tetgen/from1.poly
tetgen -pqAzQ tetgen/from0.poly
tetgen -pqAo2Q tetgen/order2.poly
rm -f tetgen/*.poly tetgen/*.face tetgen/*.edge
