import time
from fingerfem.scene.laws import *
from fingerfem.scene.laws.stability import loss
for law in (Ogden.model_construct(law="ogden",mu=[2.6e6,-.2e6],alpha=[2.5,-1.3],D1=2.43e-7), Yeoh.model_construct(law="yeoh",C1=1e4,C2=-2e2,C3=0.,D1=1e-7)):
    for m in ("uniaxial","equibiaxial","planar"):
        t=time.time(); print(law.law,m,loss(law,m,(.7,1.5)),time.time()-t,flush=True)
