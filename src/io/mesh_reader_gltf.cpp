#include <assimp/scene.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>

#include "io/mesh_reader_formats.h"
#include "io/mesh_reader_gltf_check.h"

/// glTF 2.0 and GLB through assimp, which reads Draco compression as well. The transforms of the nodes are applied;
/// each node that holds a mesh is a part.

namespace phyxel {

namespace {

Vec3 transformed(const aiMatrix4x4& m, const aiVector3D& v) {
    const double x = v.x, y = v.y, z = v.z;
    return {m.a1 * x + m.a2 * y + m.a3 * z + m.a4, m.b1 * x + m.b2 * y + m.b3 * z + m.b4,
            m.c1 * x + m.c2 * y + m.c3 * z + m.c4};
}

/// Appends one mesh; a mirroring transform turns its triangles, as the glTF specification asks (3.7.4).
void append(const aiMesh& source, const aiMatrix4x4& transform, const MeshFile& file, PolygonMesh& mesh) {
    const auto first = static_cast<std::int64_t>(mesh.vertices.size());
    for (unsigned v = 0; v < source.mNumVertices; ++v) {
        mesh.vertices.push_back(transformed(transform, source.mVertices[v]));
        if (!is_finite(mesh.vertices.back()))
            file.fail("mesh " + in_quotes(source.mName.C_Str()),
                      "vertex " + std::to_string(v) + " is not finite: mend it in the program that wrote the file");
    }
    const bool mirrored = transform.Determinant() < 0;
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
        const aiFace& face = source.mFaces[f];
        if (face.mNumIndices < 3) continue;  // points and lines
        for (unsigned k = 0; k < face.mNumIndices; ++k) {
            const unsigned index = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
            if (index >= source.mNumVertices)
                file.fail("mesh " + in_quotes(source.mName.C_Str()),
                          "a triangle uses vertex " + std::to_string(index) + ", but the mesh has " +
                              std::to_string(source.mNumVertices) + ": the file is damaged, export it again");
            mesh.corners.push_back(first + index);
        }
        mesh.end_polygon(f);
    }
}

void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, const MeshFile& file,
            PolygonMesh& mesh) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    const std::size_t begin = mesh.polygons();
    for (unsigned m = 0; m < node.mNumMeshes; ++m) append(*scene.mMeshes[node.mMeshes[m]], transform, file, mesh);
    mesh.end_part(node.mName.C_Str(), begin);
    for (unsigned c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], transform, file, mesh);
}

}  // namespace

PolygonMesh read_gltf(const MeshFile& file) {
    check_gltf(file);
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(file.path.string(), 0);
    if (scene == nullptr || scene->mRootNode == nullptr)
        file.fail("", std::string("cannot be read as glTF (") + importer.GetErrorString() + "): export it again");
    PolygonMesh mesh;
    mesh.place_unit = "triangle";
    append(*scene, *scene->mRootNode, aiMatrix4x4(), file, mesh);
    return mesh;
}

}  // namespace phyxel
