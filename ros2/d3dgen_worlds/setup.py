"""Installs the package for ROS 2."""

from glob import glob

from setuptools import setup

NAME = 'd3dgen_worlds'

setup(
    name=NAME,
    version='0.1.0',
    packages=[NAME],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + NAME]),
        ('share/' + NAME, ['package.xml', 'README.md']),
        ('share/' + NAME + '/launch', glob('launch/*.launch.py')),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='d3dgen maintainers',
    maintainer_email='maintainers@d3dgen.org',
    description='Starts worlds of d3dgen: Gazebo with a robot and nav2, and Open-RMF.',
    license='Apache-2.0',
)
