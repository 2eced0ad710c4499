export {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, GLSL3, LinearFilter, LineSegments, Matrix4, Mesh,
  OrthographicCamera, RGBAFormat, Scene, ShaderMaterial, UnsignedByteType, Vector2, Vector3, Vector4, WebGLRenderer,
  WebGLRenderTarget, Quaternion, NearestFilter, REVISION,
} from "three";
