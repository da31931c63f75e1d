# SPDX-License-Identifier: BSD-3-Clause
# As ParaView 5.11 traces it with the plugin of version 0.1.
from paraview.simple import *

wavelet1 = Wavelet(registrationName='Wavelet1')
wavelet1.WholeExtent = [-8, 8, -8, 8, -8, 8]

tetrahedralLatticeOfVolume1 = TetrahedralLatticeOfVolume(registrationName='TetrahedralLatticeOfVolume1', Volume=wavelet1)
tetrahedralLatticeOfVolume1.NumberOfNodes = [6, 6, 6]

calculator1 = Calculator(registrationName='Calculator1', Input=tetrahedralLatticeOfVolume1)
calculator1.ResultArrayName = 'Displacement'
calculator1.Function = '0.05*coordsY*coordsY*iHat'

deformVolume1 = DeformVolume(registrationName='DeformVolume1', Volume=wavelet1,
    Deformation=calculator1,
    RestMesh=None)
deformVolume1.DisplacementArray = ['POINTS', 'Displacement']
deformVolume1.OutputBoundsMode = 'Custom Bounds'
deformVolume1.CustomBounds = [-6.0, 11.0, -8.0, 8.0, -8.0, 8.0]
deformVolume1.NumberOfTimeSamples = 3
deformVolume1.StreamInput = 1
deformVolume1.WorkGroupSize = 16
