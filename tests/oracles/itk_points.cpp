// SPDX-License-Identifier: BSD-3-Clause
// itk_points COUNT FOLDER: ITK itself as a writer and as an oracle. Writes COUNT random composites NNN.h5, of affines,
// displacement fields and B-splines, in single and double precision, and NNN.points beside each: where ITK's
// TransformPoint takes random points inside and outside of its fields, six doubles each, in and out, RAS mm.
//
// itk_points POINTS FILE.h5 FILE.points: one composite of an affine and two fields of 97 x 115 x 97 nodes, with so many
// points; says the processor's seconds that ITK takes for them.
#include <itkAffineTransform.h>
#include <itkBSplineTransform.h>
#include <itkCompositeTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkEuler3DTransform.h>
#include <itkHDF5TransformIOFactory.h>
#include <itkImageRegionIterator.h>
#include <itkScaleSkewVersor3DTransform.h>
#include <itkSimilarity3DTransform.h>
#include <itkTransformFileWriter.h>
#include <itkTranslationTransform.h>

#include <cstdio>
#include <ctime>
#include <fstream>
#include <random>
#include <string>
#include <vector>

using Random = std::mt19937_64;

static double uniform(Random &random, double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(random);
}

static itk::Matrix<double, 3, 3> random_directions(Random &random)
{
    itk::Versor<double> versor;
    itk::Vector<double, 3> axis;
    for (int a = 0; a < 3; a++) {
        axis[a] = uniform(random, -1, 1);
    }
    versor.Set(axis, uniform(random, -1, 1));
    itk::Matrix<double, 3, 3> matrix = versor.GetMatrix();
    if (random() % 2) {
        for (int row = 0; row < 3; row++) {
            matrix[row][0] = -matrix[row][0];
        }
    }
    return matrix;
}

template <typename T>
static typename itk::Transform<T, 3, 3>::Pointer make_field(Random &random, const unsigned dim[3], double spacing)
{
    using Field = itk::DisplacementFieldTransform<T, 3>;
    typename Field::DisplacementFieldType::Pointer image = Field::DisplacementFieldType::New();
    typename Field::DisplacementFieldType::SizeType size;
    typename Field::DisplacementFieldType::PointType origin;
    typename Field::DisplacementFieldType::SpacingType steps;
    const itk::Matrix<double, 3, 3> directions = random_directions(random);
    for (int a = 0; a < 3; a++) {
        size[a] = dim[a];
        steps[a] = spacing * uniform(random, 0.8, 1.2);
    }
    for (int row = 0; row < 3; row++) {
        origin[row] = uniform(random, -20, 20);
        for (int a = 0; a < 3; a++) {
            origin[row] -= directions[row][a] * steps[a] * static_cast<double>(dim[a]) / 2;
        }
    }
    image->SetRegions(size);
    image->SetOrigin(origin);
    image->SetSpacing(steps);
    image->SetDirection(directions);
    image->Allocate();
    itk::ImageRegionIterator<typename Field::DisplacementFieldType> at(image, image->GetLargestPossibleRegion());
    for (; !at.IsAtEnd(); ++at) {
        typename Field::OutputVectorType vector;
        for (int a = 0; a < 3; a++) {
            vector[a] = static_cast<T>(uniform(random, -5, 5));
        }
        at.Set(vector);
    }
    typename Field::Pointer field = Field::New();
    field->SetDisplacementField(image);
    return field.GetPointer();
}

template <typename T> static typename itk::Transform<T, 3, 3>::Pointer make_spline(Random &random)
{
    using Spline = itk::BSplineTransform<T, 3, 3>;
    typename Spline::Pointer spline = Spline::New();
    typename Spline::OriginType origin;
    typename Spline::PhysicalDimensionsType sizes;
    typename Spline::MeshSizeType mesh;
    for (int a = 0; a < 3; a++) {
        origin[a] = uniform(random, -80, -20);
        sizes[a] = uniform(random, 50, 150);
        mesh[a] = 1 + random() % 6;
    }
    spline->SetTransformDomainOrigin(origin);
    spline->SetTransformDomainPhysicalDimensions(sizes);
    spline->SetTransformDomainMeshSize(mesh);
    spline->SetTransformDomainDirection(random_directions(random));
    typename Spline::ParametersType numbers(spline->GetNumberOfParameters());
    for (unsigned i = 0; i < numbers.Size(); i++) {
        numbers[i] = static_cast<T>(uniform(random, -5, 5));
    }
    spline->SetParametersByValue(numbers);
    return spline.GetPointer();
}

// A transform whose first parameters are turns or a matrix; the others are their defaults with noise.
template <typename Kind, typename T>
static typename itk::Transform<T, 3, 3>::Pointer make_affine(Random &random, double noise)
{
    typename Kind::Pointer made = Kind::New();
    typename Kind::ParametersType numbers = made->GetParameters();
    typename Kind::FixedParametersType fixed = made->GetFixedParameters();
    for (unsigned i = 0; i < numbers.Size(); i++) {
        numbers[i] += static_cast<T>(uniform(random, -noise, noise));
    }
    for (unsigned i = 0; i < fixed.Size() && i < 3; i++) {
        fixed[i] = uniform(random, -30, 30);
    }
    made->SetFixedParameters(fixed);
    made->SetParameters(numbers);
    return made.GetPointer();
}

template <typename T> static typename itk::Transform<T, 3, 3>::Pointer make_step(Random &random)
{
    const unsigned dim[3] = {2 + unsigned(random() % 8), 2 + unsigned(random() % 8), 2 + unsigned(random() % 8)};
    switch (random() % 8) {
    case 0:
        return make_affine<itk::AffineTransform<T, 3>, T>(random, 0.2);
    case 1:
        return make_affine<itk::Euler3DTransform<T>, T>(random, 0.5);
    case 2:
        return make_affine<itk::VersorRigid3DTransform<T>, T>(random, 0.3);
    case 3:
        return make_affine<itk::Similarity3DTransform<T>, T>(random, 0.2);
    case 4:
        return make_affine<itk::ScaleSkewVersor3DTransform<T>, T>(random, 0.1);
    case 5:
        return make_affine<itk::TranslationTransform<T, 3>, T>(random, 20);
    case 6:
        return make_spline<T>(random);
    default:
        return make_field<T>(random, dim, 15);
    }
}

template <typename T> static void write(const itk::Transform<T, 3, 3> *transform, const std::string &path)
{
    typename itk::TransformFileWriterTemplate<T>::Pointer writer = itk::TransformFileWriterTemplate<T>::New();
    writer->SetInput(transform);
    writer->SetFileName(path);
    writer->Update();
}

// Moves points and writes them; returns the processor's seconds.
template <typename T>
static double move(Random &random, const itk::Transform<T, 3, 3> *transform, size_t count, const std::string &path)
{
    std::vector<double> points(6 * count);
    for (size_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            points[6 * i + a] = static_cast<T>(uniform(random, -90, 90));
        }
    }
    const std::clock_t start = std::clock();
    for (size_t i = 0; i < count; i++) {
        double *p = &points[6 * i];
        typename itk::Transform<T, 3, 3>::InputPointType in;
        in[0] = static_cast<T>(-p[0]), in[1] = static_cast<T>(-p[1]), in[2] = static_cast<T>(p[2]);
        const typename itk::Transform<T, 3, 3>::OutputPointType out = transform->TransformPoint(in);
        p[3] = -out[0], p[4] = -out[1], p[5] = out[2];
    }
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char *>(points.data()), std::streamsize(points.size() * sizeof(double)));
    return seconds;
}

template <typename T> static void make_random(Random &random, const std::string &stem)
{
    typename itk::CompositeTransform<T, 3>::Pointer chain = itk::CompositeTransform<T, 3>::New();
    for (size_t count = 1 + random() % 12; count > 0; count--) {
        chain->AddTransform(make_step<T>(random));
    }
    write<T>(chain.GetPointer(), stem + ".h5");
    move<T>(random, chain.GetPointer(), 200, stem + ".points");
}

int main(int argc, char **argv)
{
    Random random(39);
    itk::HDF5TransformIOFactory::RegisterOneFactory();
    if (argc == 3) {
        for (int i = 0; i < std::stoi(argv[1]); i++) {
            const std::string stem = argv[2] + ("/" + std::to_string(i));
            i % 2 ? make_random<float>(random, stem) : make_random<double>(random, stem);
        }
        return 0;
    }
    if (argc != 4) {
        return 2;
    }
    const unsigned dim[3] = {97, 115, 97};
    itk::CompositeTransform<double, 3>::Pointer chain = itk::CompositeTransform<double, 3>::New();
    chain->AddTransform(make_affine<itk::AffineTransform<double, 3>, double>(random, 0.1));
    chain->AddTransform(make_field<double>(random, dim, 2));
    chain->AddTransform(make_field<double>(random, dim, 2));
    write<double>(chain.GetPointer(), argv[2]);
    std::printf("%.3f\n", move<double>(random, chain.GetPointer(), std::stoul(argv[1]), argv[3]));
    return 0;
}
