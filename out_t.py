import time,sys
from fingerfem import FingerModel, load_scene
from fingerfem.scene.laws import *
which=sys.argv[1]
t=time.time()
s=load_scene("scenes/draft.toml")
if which=="yeoh": s=s.model_copy(update={"material":Yeoh(C1=1.9e6,C2=.4e6,D1=2.43e-7)})
if which=="ogden2": s=s.model_copy(update={"material":Ogden(mu=[3.8e6],alpha=[2.0],D1=2.43e-7)})
if which=="ogden": s=s.model_copy(update={"material":Ogden(mu=[2.6e6,-.2e6],alpha=[2.5,-1.3],D1=2.43e-7)})
m=FingerModel(s); print(which,"built",time.time()-t); t=time.time()
st=m.solve([50.,0.],distance=.005); print(repr(st.contact_force),st.newton_iterations,time.time()-t)
