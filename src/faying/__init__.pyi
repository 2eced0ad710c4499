# The public names. Each is imported when it is first used (lazy_loader reads this file).
from . import contact
from .asperity_fe import solve_asperity
from .contact.auto import law_for
from .contact.half_space import HalfSpace
from .contact.jk import JK
from .decks.matrices import read_matrices
from .decks.meshfile import read_mesh
from .distribution import Distribution
from .errors import FayingError, InputError, NotConverged, ReadError
from .fe.mesh import Mesh
from .halfspace import solve_half_space
from .identify.identification import Identification
from .identify.of_study import identify
from .identify.predict import predict
from .identify.prediction import Prediction
from .joint.bolt import Bolt, Washer
from .joint.flatness import minimum_zone
from .joint.form import Form
from .joint.form_fit import fit_form
from .joint.gap_map import FaceMap, GapMap
from .joint.solid_bolt import SolidBolt
from .joint.structure import Joint, Structure
from .joint.waviness import Waviness
from .materials import CATALOGUE, RIGID, ContactPair, Material
from .measured.compare import compare_modes
from .measured.frf import FRF
from .measured.identify import identify_modes
from .measured.model import ModelModes
from .measured.records import frf_from_records
from .measured.ring_down import MeasuredBackbone, ring_down, ring_down_of_frf
from .measured.uff import read_uff
from .measured.uff_write import write_uff
from .result import Result, read_model_modes
from .result.backbone import Backbone
from .study import Study, run
from .study.attach import attach
from .study.axes import axis_of
from .study.backbone import backbone
from .study.sweep import sweep
from .surface import synthesize
from .surface.combine import Combined, combine
from .surface.fractal import FractalFit, fit_fractal
from .surface.read import read_scan
from .surface.scan import Profile, Scan
from .surface.write import write_scan

__version__: str
