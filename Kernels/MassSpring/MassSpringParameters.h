// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of mass-spring dynamics work on. Shared by the C++ code and the kernels:
// four-byte numbers only, so that both sides lay it out alike.
#ifndef DeformVolumeMassSpringParameters_h
#define DeformVolumeMassSpringParameters_h

typedef struct
{
  float TimeStep;
  float Retained;   // of the velocity in a step, by damping
  float Gravity[3]; // m/s^2
  float Limit;      // displacements beyond this mean that the simulation has diverged
  int NumberOfNodes;
} MassSpringStep;

typedef struct
{
  int Node;
  float Begin[3]; // displacements
  float End[3];
} MassSpringHandle;

#endif
